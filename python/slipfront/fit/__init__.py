# SPDX-License-Identifier: BSD-3-Clause
"""Which values of a case's keys explain an experiment's records, with intervals. docs/fit.md

`space`: ranges of the free keys. `likelihood`: how probable a run makes the records. `emulator`: what runs
would compute at other points. `posterior`: what follows for the free keys. `combinations`: what is determined
in place of keys that are not. `fitting`: from the first runs to the posterior. `outcome`: the files."""
