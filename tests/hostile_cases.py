"""Files that no instrument wrote, for the tests of hostile ones."""

from __future__ import annotations

import io
import os
import zipfile

import numpy as np
import pytest

import microfacet as mf

HEIGHTS = np.random.default_rng(0).normal(size=(6, 7))


def archive(members, compression=zipfile.ZIP_STORED):
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", compression) as file:
        for name, content in members.items():
            file.writestr(name, content)
    return stream.getvalue()


def check_refused(file, message, **options):
    with pytest.raises(mf.SurfaceError, match=message) as caught:
        mf.read_surface(file, **options)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 400 + len(str(file))
    assert not os.path.exists("trapped")


def x3p(xml, data):
    return archive({"main.xml": xml, "bindata/data.bin": data})
