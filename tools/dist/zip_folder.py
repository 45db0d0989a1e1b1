"""Packs a folder into a zip. Equal files give equal bytes; SOURCE_DATE_EPOCH is the time of all files.

    zip_folder.py FOLDER OUT.zip
"""

import os
import sys
import time
import zipfile
from pathlib import Path


def write_zip(out: Path, files: dict[str, Path]) -> None:
    """Writes a zip. The keys of `files` are the names in the zip."""
    when = time.gmtime(int(os.environ.get("SOURCE_DATE_EPOCH", 315532800)))[:6]  # a zip cannot store a time before 1980
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name, path in sorted(files.items()):
            entry = zipfile.ZipInfo(name, when)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o100755 if path.name in ("chronormal", "chronormal.exe") else 0o100644) << 16
            archive.writestr(entry, path.read_bytes())


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    write_zip(Path(sys.argv[2]), {f"{folder.name}/{path.relative_to(folder).as_posix()}": path
                                  for path in folder.rglob("*") if path.is_file()})
