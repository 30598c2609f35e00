# SPDX-License-Identifier: BSD-3-Clause
"""The figures of Kammer et al. (2012), and what the pages beside this folder show."""
