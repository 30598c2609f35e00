# SPDX-License-Identifier: BSD-3-Clause
"""Figures of runs, sequences and studies of a case. For figures of one's own: `style` and `drawing`."""
