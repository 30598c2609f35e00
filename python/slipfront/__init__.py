# SPDX-License-Identifier: BSD-3-Clause
"""Reading and drawing the results of slipfront. Nothing is computed here that the program does not write."""
