# SPDX-License-Identifier: BSD-3-Clause
"""Runs beside an experiment's records: onsets, traces, speeds over the stress ratio, cycles of stick-slip.
docs/compare.md

A kind of record is a module here and a line of KINDS in `kinds`. A comparison is a data set whose
`misfit_of_all` is 0 where run and record agree, with its standard error."""
