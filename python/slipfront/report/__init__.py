# SPDX-License-Identifier: BSD-3-Clause
"""A page of HTML to look at results in a browser: one file, which needs no network.

`command.py` finds out what kind of results a folder holds; a module for each kind makes a `Page` of them;
`page.py` writes it, with the scripts of page/ that draw in the browser."""
