# SPDX-License-Identifier: BSD-3-Clause
"""The paper's figures and a report, drawn from an output folder of `slipfront reproduce`."""
