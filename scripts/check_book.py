"""Checks a built book and the pages it is made of.

    mdbook build && python scripts/check_book.py target/book

In the book: every page of docs/ is there and in the table of contents, every relative link, anchor and image resolves,
and nothing is loaded from a network. A link that leaves the book must lead to a file of the repository, seen from the
page it stands on. In the texts: the README's links, and files, schemas and tests that pages name. Exit code 1 if
anything is wrong, after all of it was told.
"""

import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

from markdown_it import MarkdownIt

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
# Texts outside of the book whose links are checked too.
OTHER_TEXTS = ["README.md", "data/README.md", "schemas/README.md", "benches/peers/README.md"]
LOADED = {("img", "src"), ("script", "src"), ("iframe", "src"), ("link", "href"), ("source", "src")}
FOLDERS = "benches|data|docs|examples|fuzz|pipelines|schemas|scripts|src|tests"
NAMED_FILE = re.compile(rf"`((?:{FOLDERS})/[\w./-]+)`")
NAMED_SCHEMA = re.compile(r"`(asperity\.\w+\.\w+)`|(?<=, )`(\.\w+)`")
# Tests have names like sentences; keys and columns are shorter.
NAMED_TEST = re.compile(r"`([a-z]\w*(?:_\w+){3,})`")


class Page(HTMLParser):
    """Anchors, links and loaded files of an HTML text."""

    def __init__(self, text):
        super().__init__()
        self.anchors = set()
        self.links = []
        self.loads = []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        for name, value in attrs:
            if not value:
                continue
            if name == "id" or (tag == "a" and name == "name"):
                self.anchors.add(value)
            if (tag, name) == ("a", "href"):
                self.links.append(value)
            if (tag, name) in LOADED:
                self.loads.append(value)


def outside(target, page, book):
    """Where a link out of the book leads in the repository: from the text that the page was made of."""
    source = DOCS / page.parent.relative_to(book)
    file = (source / target).resolve()
    # mdBook turns every .md of a link into .html.
    return file if file.exists() or file.suffix != ".html" else file.with_suffix(".md")


def problem_of(link, page, pages, book):
    """What is wrong with a link of a page of the book; None if nothing is."""
    parts = urlsplit(link)
    if parts.scheme or parts.netloc:
        return None if parts.scheme in ("http", "https", "mailto", "data") else "has a strange scheme"
    target = unquote(parts.path)
    file = (page.parent / target).resolve() if target else page
    if file.is_dir():
        file = file / "index.html"
    if not file.is_relative_to(book):
        there = outside(target, page, book)
        kept = there.is_relative_to(ROOT) and there.exists()
        return None if kept else "leads to no file of the repository"
    if not file.is_file():
        return "leads to nothing"
    if parts.fragment and file in pages and unquote(parts.fragment) not in pages[file].anchors:
        return "has an anchor that is not there"
    return None


def check_book(book):
    pages = {path: Page(path.read_text(encoding="utf-8")) for path in sorted(book.rglob("*.html"))}
    listed = {(book / unquote(urlsplit(link).path)).resolve() for link in pages[book / "toc.html"].links}
    links = 0
    for path, page in pages.items():
        name = path.relative_to(book)
        for link in page.links + page.loads:
            links += 1
            if problem := problem_of(link, path, pages, book):
                yield f"{name}: {link} {problem}"
        for load in page.loads:
            if urlsplit(load).netloc:
                yield f"{name}: {load} is loaded from a network"
    sources = [path for path in sorted(DOCS.rglob("*.md")) if path.name != "SUMMARY.md"]
    for source in sources:
        made = book / source.relative_to(DOCS).with_suffix(".html")
        if made not in listed or made not in pages:
            yield f"{source.relative_to(ROOT)} is not in docs/SUMMARY.md"
    print(f"{book.name}: {len(pages)} pages of {len(sources)} texts, {links} links")


def check_other_links():
    """Links of texts outside of the book, by their Markdown."""
    for name in OTHER_TEXTS:
        path = ROOT / name
        page = Page(MarkdownIt("commonmark").enable("table").render(path.read_text(encoding="utf-8")))
        for link in page.links + page.loads:
            parts = urlsplit(link)
            if not parts.scheme and not (path.parent / unquote(parts.path)).exists():
                yield f"{name}: {link} leads to nothing"


def code_of_tests():
    files = [path for folder in ("src", "tests", "crates") for path in (ROOT / folder).rglob("*.rs")]
    return "\n".join(path.read_text(encoding="utf-8") for path in files)


def schema_names():
    return {re.sub(r"\.v\d+\.json$", "", path.name) for path in (ROOT / "schemas").glob("*.json")}


def check_names():
    """Files that pages name, and on the pages of the stages schemas and tests."""
    code, schemas = code_of_tests(), schema_names()
    for path in sorted(DOCS.rglob("*.md")):
        text, name = path.read_text(encoding="utf-8"), path.relative_to(ROOT)
        for file in NAMED_FILE.findall(text):
            if not (ROOT / file).exists():
                yield f"{name} names {file}, which is not there"
        if path.parent.name != "stages":
            continue
        for full, last in NAMED_SCHEMA.findall(text):
            schema = full or f"asperity.{path.stem}{last}"
            if schema not in schemas:
                yield f"{name} names the schema {schema}, which is not there"
        _, _, checked = text.partition("## Checked by")
        for test in NAMED_TEST.findall(checked):
            if f"fn {test}(" not in code:
                yield f"{name} names the test {test}, which is not there"
        for schema in sorted(schemas):
            if schema.startswith(f"asperity.{path.stem}.") and schema.split(".")[-1] not in text:
                yield f"{name} does not name the schema {schema}"


def main(arguments):
    if len(arguments) != 1:
        sys.exit(__doc__)
    book = Path(arguments[0]).resolve()
    problems = [*check_book(book), *check_other_links(), *check_names()]
    for problem in problems:
        print(f"check_book: {problem}")
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main(sys.argv[1:])
