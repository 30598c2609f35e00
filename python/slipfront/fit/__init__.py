# SPDX-License-Identifier: BSD-3-Clause
"""Which values of a case's keys explain an experiment's records, with intervals. docs/fit.md

`space`: ranges of the free keys. `likelihood`: records, and how probable they make a run. `emulator`: runs
between the runs. `posterior`: what follows for the free keys. `fitting`: from the first runs to the result."""
