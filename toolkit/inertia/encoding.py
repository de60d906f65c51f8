"""Text files: UTF-8, with a byte order mark or without; UTF-16 is called so, whether it has one or not."""

from __future__ import annotations

import re

from inertia.errors import ReadError

UTF_16 = re.compile(rb"\xff\xfe|\xfe\xff|(?:[\t\n\r -~]\x00){2}|(?:\x00[\t\n\r -~]){2}")
"""How text in UTF-16 begins, where it is known to be text: in UTF-8, no zero byte belongs there."""


def require_no_utf_16(head: bytes) -> None:
    """Raise `ReadError` where text that begins so is in UTF-16."""
    if UTF_16.match(head):
        raise ReadError("it is text in UTF-16: save it as UTF-8", code="encoding")


def text_of(data: bytes, remedy: str = "save it as UTF-8") -> str:
    r"""Return the text of a file, without a byte order mark.

    Raises `ReadError`, with the `remedy`, where it is not in UTF-8.

    >>> text_of("name,mass\n".encode("utf-16-le"))
    Traceback (most recent call last):
    inertia.errors.ReadError: it is text in UTF-16: save it as UTF-8
    >>> text_of(b"name\nM\xfcller\n", "save the table as CSV in UTF-8")
    Traceback (most recent call last):
    inertia.errors.ReadError: it is no text in UTF-8, from line 2 on: save the table as CSV in UTF-8
    """
    require_no_utf_16(data)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        where = "" if line == 1 else f", from line {line} on"
        raise ReadError(f"it is no text in UTF-8{where}: {remedy}", code="encoding") from None
