#!/usr/bin/env python3
"""Checks the links and pictures of the built book: `python3 assets/check_book.py target/book/docs`. Links to the web are not
followed."""
import html.parser
import sys
from pathlib import Path
from urllib.parse import unquote


class Page(html.parser.HTMLParser):
    """The targets of a page, and the names that links into it may end in."""

    def __init__(self, path):
        super().__init__()
        self.targets, self.names = [], {""}
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        for key, value in attributes:
            if key == "id" or (key == "name" and tag == "a"):
                self.names.add(value)
            elif (tag, key) in {("a", "href"), ("img", "src")} and value:
                self.targets.append(value)


def main():
    root = Path(sys.argv[1])
    pages = {path.resolve(): Page(path) for path in root.rglob("*.html") if path.name not in {"404.html", "print.html"}}
    wrong = []
    count = 0
    for path, page in pages.items():
        for target in page.targets:
            file, _, name = target.partition("#")
            if "://" in target or target.startswith(("mailto:", "data:")):
                continue
            where = (path.parent / unquote(file)).resolve() if file else path
            if not where.exists():
                wrong.append(f"{path.relative_to(root.resolve())}: {target} does not exist")
            elif where in pages and unquote(name) not in pages[where].names:
                wrong.append(f"{path.relative_to(root.resolve())}: {target} has no such heading")
            count += 1
    print("\n".join(wrong))
    if wrong or len(pages) < 40 or count < 500:
        sys.exit(f"{len(pages)} pages, {count} links, {len(wrong)} of them wrong")
    print(f"{len(pages)} pages, {count} links")


main()
