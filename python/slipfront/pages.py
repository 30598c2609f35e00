# SPDX-License-Identifier: BSD-3-Clause
"""Pages of Markdown that results renew: a table is between lines `<!-- NAME -->` and `<!-- end of NAME -->`,
what is around it stays; the picture of a page `some-thing.md` is `figures/some_thing.png` beside it."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from slipfront import command
from slipfront.figures.drawing import checked
from slipfront.files import DataError, read_json, read_text
from slipfront.folder import result_file

#: A page's tables, by their names.
Tables = dict[str, str]


def read_result(file: Path) -> Any:
    """A JSON file of a folder of results, refused where it is not as the folder's checksums say."""
    return read_json(result_file(file))


@contextmanager
def expecting(what: str, file: Path) -> Iterator[None]:
    """Whatever values of a file are missing or of another kind is told as one error."""
    try:
        yield
    except (AttributeError, IndexError, KeyError, OverflowError, TypeError, ValueError) as error:
        raise DataError(f"{file}: not {what}: {type(error).__name__}: {error}") from None


def tables_of(file: Path, what: str, tables: Callable[[Any], Tables]) -> Tables:
    """Made from a file of results, which is told where it is not `what`."""
    results = read_result(file)
    with expecting(what, file):
        return tables(results)


def table(header: list[str], rows: list[list[str]]) -> str:
    """In Markdown; strokes in cells are escaped."""
    lines = [header, *rows]
    text = ["| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |\n" for line in lines]
    return "".join([text[0], "|" + "---|" * len(header) + "\n", *text[1:]])


def with_tables(page: Path, text: str, tables: Tables) -> str:
    """The page's text with its tables replaced."""
    for name, content in tables.items():
        start, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->"
        before, found_start, rest = text.partition(start)
        _, found_end, after = rest.partition(end)
        if not found_start or not found_end:
            raise DataError(f"{page}: no lines {start.strip()} and {end}")
        text = before + start + content + end + after
    return text


def write_pages(folder: Path, pages: dict[str, str]) -> None:
    """Writes pages of a folder, by their names; after an error each is as before."""
    for name in pages:
        command.replaceable(folder / name)
    with command.publishing_into(folder) as made:
        for name, text in pages.items():
            (made / name).write_bytes(text.encode())


def command_to_renew(
    script: str, purpose: str | None, page: Path, write: Callable[[Path, Path], Tables], results: str = ""
) -> int:
    """Exit code of a script that renews a page, and its picture.

    write(folder, picture): draws the picture, if the page has one, and returns the page's tables. The folder
    is that of the results of a command or, where none is named, one for runs, which may be there."""
    parser = argparse.ArgumentParser(description=purpose)
    if results:
        parser.add_argument("folder", metavar="DIR", type=Path, help=f"output folder of `{results}`")
    else:
        parser.add_argument("--runs", dest="folder", type=Path, help="folder of the runs, or for them")
    parser.add_argument("--page", type=Path, default=page, help="default: %(default)s")
    options = parser.parse_args()

    def work() -> list[str]:
        text = read_text(command.replaceable(options.page))
        picture = options.page.parent / "figures" / f"{options.page.stem.replace('-', '_')}.png"
        checked(picture)
        with TemporaryDirectory() as temporary:
            folder = options.folder or Path(temporary)
            if not results:
                folder.mkdir(parents=True, exist_ok=True)
            tables = write(folder, picture)
        write_pages(options.page.parent, {options.page.name: with_tables(options.page, text, tables)})
        return []

    return command.run(Path(script).name, work)
