# SPDX-License-Identifier: GPL-3.0-or-later
"""Packs the add-on and the wheels that it needs into one zip, which Blender 3.4 and later can install.

`python make_extension.py WHEELS DIST`: WHEELS is a folder of wheels, DIST the folder for the zip. `./dev extension`
builds the wheels and calls it.
"""

from __future__ import annotations

import re
import sys
import tomllib
import zipfile
from pathlib import Path

ADDON = Path(__file__).resolve().parent / "shlight_blender"
LICENSE = ADDON.parent / "LICENSE"
# The same sources give the same zip.
DATE = (1980, 1, 1, 0, 0, 0)


def make_extension(wheels: Path, dist: Path) -> Path:
    """Writes the zip, and returns its path. All is in one folder: Blender before 4.2 takes that for the add-on's."""
    manifest = (ADDON / "blender_manifest.toml").read_text(encoding="utf-8")
    fields = tomllib.loads(manifest)
    names = sorted(path.name for path in wheels.glob("*.whl"))
    if not names:
        raise SystemExit(f"make_extension: there are no wheels in {wheels}")
    version = next(name for name in names if name.startswith("shlight-")).split("-")[1]
    manifest = re.sub("^version = .*", f'version = "{version}"', manifest, count=1, flags=re.MULTILINE)
    listed = "".join(f'  "./wheels/{name}",\n' for name in names)
    # Before the first table, where keys of the whole file belong.
    head, table, rest = manifest.partition("\n[")
    manifest = f"{head}wheels = [\n{listed}]\n{table}{rest}"
    dist.mkdir(parents=True, exist_ok=True)
    path = dist / f"shlight-{version}-{fields['platforms'][0]}.zip"
    unfinished = path.with_suffix(".part")
    with zipfile.ZipFile(unfinished, "w", zipfile.ZIP_DEFLATED) as archive:
        _write(archive, "blender_manifest.toml", manifest.encode())
        _write(archive, "LICENSE", LICENSE.read_bytes())
        for source in sorted(path for path in ADDON.rglob("*") if path.suffix in (".py", ".osl")):
            _write(archive, source.relative_to(ADDON).as_posix(), source.read_bytes())
        for name in names:
            _write(archive, f"wheels/{name}", (wheels / name).read_bytes(), zipfile.ZIP_STORED)
    unfinished.replace(path)
    return path


def _write(archive: zipfile.ZipFile, name: str, content: bytes, compression: int = zipfile.ZIP_DEFLATED) -> None:
    entry = zipfile.ZipInfo(f"{ADDON.name}/{name}", DATE)
    entry.compress_type = compression
    entry.external_attr = 0o644 << 16
    archive.writestr(entry, content)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        raise SystemExit(__doc__)
    print(make_extension(Path(sys.argv[1]), Path(sys.argv[2])))
