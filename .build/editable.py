"""The build backend: that of setuptools, whose editable installs also hold beside a clone's folder.

A clone lies in a folder named tol3d, and a script beside it finds that folder first. Python takes it for a package
without code, a namespace package, before it asks the finder that setuptools puts last for an editable install; then
`tol3d.run_scene` is not there. So an editable install gets one module more, `past_namespace.py`, and a .pth file that
imports it when Python starts.
"""

import base64
import hashlib
import io
import tarfile
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from setuptools import build_meta
from setuptools.build_meta import (
    build_wheel,
    get_requires_for_build_editable,
    get_requires_for_build_sdist,
    get_requires_for_build_wheel,
    prepare_metadata_for_build_editable,
    prepare_metadata_for_build_wheel,
)

__all__ = [
    "build_editable",
    "build_sdist",
    "build_wheel",
    "get_requires_for_build_editable",
    "get_requires_for_build_sdist",
    "get_requires_for_build_wheel",
    "prepare_metadata_for_build_editable",
    "prepare_metadata_for_build_wheel",
]

HERE = Path(__file__).resolve().parent
MODULE = "_tol3d_past_namespace"


Settings = Mapping[str, Any] | None


def build_editable(
    wheel_directory: str, config_settings: Settings = None, metadata_directory: str | None = None
) -> str:
    """setuptools' wheel of an editable install, and the module with its .pth file."""
    name = build_meta.build_editable(wheel_directory, config_settings, metadata_directory)
    added = {
        f"{MODULE}.py": (HERE / "past_namespace.py").read_bytes(),
        f"{MODULE}.pth": f"import {MODULE}\n".encode(),
    }
    path = Path(wheel_directory, name)
    with zipfile.ZipFile(path) as wheel:
        files = {file.filename: wheel.read(file) for file in wheel.infolist()}
    (record,) = (file for file in files if file.endswith(".dist-info/RECORD"))
    files[record] = "".join(_record_line(*file) for file in added.items()).encode() + files[record]
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as wheel:
        for file, content in (added | files).items():
            wheel.writestr(file, content)
    return name


def _record_line(file: str, content: bytes) -> str:
    digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).decode().rstrip("=")
    return f"{file},sha256={digest},{len(content)}\n"


def build_sdist(sdist_directory: str, config_settings: Settings = None) -> str:
    """setuptools' source archive, and this folder, which builds wheels from it."""
    name = build_meta.build_sdist(sdist_directory, config_settings)
    path = Path(sdist_directory, name)
    content = path.read_bytes()
    with tarfile.open(fileobj=io.BytesIO(content)) as plain, tarfile.open(path, "w:gz") as whole:
        for member in plain:
            whole.addfile(member, plain.extractfile(member) if member.isfile() else None)
        for file in sorted(HERE.glob("*.py")):
            whole.add(file, f"{name.removesuffix('.tar.gz')}/{HERE.name}/{file.name}")
    return name
