# SPDX-License-Identifier: BSD-3-Clause
"""`python -m slipfront.sweep`, the same as `slipfront sweep`."""

import sys

from slipfront.sweep.command import main

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
