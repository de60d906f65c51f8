"""Inflate the parts of a zip archive that a reader needs, and never more than a sane archive holds."""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from pathlib import Path

from inertia.errors import ReadError

_SIZE_LIMIT = 4 * 2**30
_RATIO_LIMIT = 200
_RATIO_FREE = 64 * 2**20  # up to this size it does no harm, however well it packs
_BLOCK = 2**20


def inflate(path: Path, needs: Callable[[str], bool]) -> dict[str, bytes]:
    """Return the members whose name `needs` says yes to; names are in lower case and without a leading slash.

    The size is checked twice: as the archive declares it, for all members, and as it comes out.
    """
    packed = path.stat().st_size
    members: dict[str, bytes] = {}
    try:
        with zipfile.ZipFile(path) as archive:
            _check(sum(info.file_size for info in archive.infolist()), packed)
            total = 0
            for info in archive.infolist():
                name = info.filename.lstrip("/").lower()
                if not needs(name):
                    continue
                blocks = []
                with archive.open(info) as stream:
                    while block := stream.read(_BLOCK):
                        total += len(block)
                        _check(total, packed)
                        blocks.append(block)
                members[name] = b"".join(blocks)
    except (ReadError, MemoryError):
        raise
    except Exception as error:  # zipfile lets through whatever its parsers and decompressors raise
        raise ReadError(
            f"it is a damaged zip archive ({type(error).__name__}): export it again", code="damaged_archive"
        ) from None
    return members


def _check(size: int, packed: int) -> None:
    limit = min(_SIZE_LIMIT, max(_RATIO_FREE, _RATIO_LIMIT * packed))
    if size > limit:
        raise ReadError(
            f"its {packed} bytes unpack to {size} or more, beyond the {limit} allowed: it is damaged or a zip bomb",
            code="too_large",
        )
