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


def npy(array, **options):
    stream = io.BytesIO()
    np.lib.format.write_array(stream, np.asanyarray(array), **options)
    return stream.getvalue()


def x3p_index(nx, ny):
    axes = "".join(
        f"<{axis}><AxisType>{kind}</AxisType><DataType>D</DataType><Increment>1e-6</Increment></{axis}>"
        for axis, kind in (("CX", "I"), ("CY", "I"), ("CZ", "A"))
    )
    return (
        '<?xml version="1.0"?><p:ISO5436_2 xmlns:p="http://www.opengps.eu/2008/ISO5436_2"><Record1>'
        f"<Revision>ISO5436 - 2000</Revision><FeatureType>SUR</FeatureType><Axes>{axes}</Axes></Record1>"
        f"<Record3><MatrixDimension><SizeX>{nx}</SizeX><SizeY>{ny}</SizeY><SizeZ>1</SizeZ></MatrixDimension>"
        "<DataLink><PointDataLink>bindata/data.bin</PointDataLink></DataLink></Record3></p:ISO5436_2>"
    )


INDEX, DATA = x3p_index(7, 6), HEIGHTS.tobytes()
