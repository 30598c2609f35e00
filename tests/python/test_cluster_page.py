# SPDX-License-Identifier: BSD-3-Clause
"""The page on clusters shows the job script that `make slurm-mpi-trial` runs."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_the_page_has_the_script():
    page = (ROOT / "docs/cluster.md").read_text(encoding="utf-8")
    shown = re.findall(r"^```bash\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
    assert shown == [(ROOT / "scripts/slurm-run.sh").read_text(encoding="utf-8")]
