"""The base install is NumPy and SciPy; each other library may be missing, and then one sentence says so."""

from __future__ import annotations

import json
import pathlib
import re
import subprocess
import sys
import tomllib
from collections.abc import Callable

import pytest

import microfacet as mf
from microfacet._optional import EXTRAS, installed, needed, require, sentence

ROOT = pathlib.Path(__file__).parent.parent
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PROJECT = PYPROJECT["project"]
LIBRARIES = sorted({library for libraries in EXTRAS.values() for library in libraries})

# What a process begins with that shall not find them: neither does `find_spec`.
WITHOUT = """
import sys
class Missing:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {names!r}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)
sys.meta_path.insert(0, Missing())
"""


def python(code: str, without: list[str], *arguments: str, **options: object) -> subprocess.CompletedProcess:
    """A process that has none of the libraries."""
    program = [sys.executable, "-c", WITHOUT.format(names=without) + code, *arguments]
    return subprocess.run(program, capture_output=True, text=True, **options)


def requirements(extra: str) -> set[str]:
    """The names of what an extra of pyproject.toml brings, those of other extras of ours among them."""
    found = set()
    for requirement in PROJECT["optional-dependencies"][extra]:
        if own := re.fullmatch(r"microfacet\[(.*)\]", requirement):
            found |= set().union(*map(requirements, own[1].split(",")))
        else:
            found.add(named(requirement))
    return found


def named(requirement: str) -> str:
    return re.split(r"[\[<>=~!; ]", requirement)[0]


def test_the_base_install_is_numpy_and_scipy() -> None:
    assert [named(requirement) for requirement in PROJECT["dependencies"]] == ["numpy", "scipy"]


def test_extras_bring_what_the_sentences_promise() -> None:
    assert set(PROJECT["optional-dependencies"]) == {*EXTRAS, "all"}
    for extra, libraries in EXTRAS.items():
        missing = {*libraries} - {"drjit"} - requirements(extra)  # Mitsuba brings Dr.Jit
        assert not missing, f"{extra} does not bring {missing}"
    # PyTorch's wheels bring gigabytes of CUDA libraries: who wants them asks for them.
    assert set(LIBRARIES) - {"drjit", "torch"} <= requirements("all")


def test_make_installs_what_the_report_and_the_tests_need() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    (package,) = re.findall(
        r"^\$\(INSTALLED\):(?:.*\n)(?:\t.*\n)*?\t.*install .*(\S\.\[.*\]\S)\)$", makefile, re.MULTILINE
    )
    assert package == '".[report]"'
    (tests,) = re.findall(r"^\$\(VENV\)/\.test:.*\n\t(.*)$", makefile, re.MULTILINE)
    assert "--group test" in tests
    assert "optional-dependencies surface" in tests
    group = {named(requirement) for requirement in PYPROJECT["dependency-groups"]["test"]}
    assert requirements("all") <= requirements("report") | requirements("surface") | group | {"distributed"}
    (dask,) = [text for text in PYPROJECT["dependency-groups"]["test"] if text.startswith("dask")]
    assert "distributed" in dask


@pytest.mark.parametrize("library", LIBRARIES)
def test_the_sentence_names_library_and_both_commands(library: str) -> None:
    said = sentence("tests need", library)
    assert said.startswith(f"tests need {library}, ")
    (extra,) = re.findall(r'pip install "\.\[(\w+)\]" in a checkout', said)
    assert f'pip install "WHEEL[{extra}]"' in said
    assert library in EXTRAS[extra]
    assert "\n" not in said


def test_what_is_missing_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    assert installed("numpy")
    assert not installed("a_library_that_nobody_wrote")
    monkeypatch.setitem(sys.modules, "jinja2", None)
    assert not installed("jinja2")
    with pytest.raises(ImportError, match=r"pages need jinja2, .*\[report\]"), needed("pages need"):
        import jinja2  # noqa: F401
    with pytest.raises(ImportError, match=r"pages need jinja2, .*\[report\]"):
        require("pages need", "report")
    with pytest.raises(ModuleNotFoundError, match="nobody_wrote"), needed("pages need"):
        import a_library_that_nobody_wrote  # noqa: F401


def test_nothing_says_that_the_package_lies_on_an_index() -> None:
    folders = ("docs", "src", "include", "bindings", "examples", "tools", "benchmarks", "tests")
    paths = [path for folder in folders for path in (ROOT / folder).rglob("*") if path.is_file()]
    for path in [*ROOT.iterdir(), *paths]:
        if path.is_file() and path.suffix in {
            ".md",
            ".py",
            ".hpp",
            ".cpp",
            ".toml",
            ".cff",
            ".j2",
            ".txt",
            ".ipynb",
            "",
        }:
            text = path.read_text(encoding="utf-8", errors="replace")
            found = re.search(r"(?:pip|uv|pipx|conda|poetry) (?:install|add)[ \\]+[\"'`]*microfacet\b", text)
            assert not found, f"{path.relative_to(ROOT)}: {found}"


# Every public function works or says what it lacks

CALLS = """
import json, pathlib, tempfile
import numpy as np
import microfacet as mf
folder = pathlib.Path(tempfile.mkdtemp())
(folder / "map.opd").write_bytes(b"PK")
(folder / "map.png").write_bytes(b"PNG")
(folder / "slopes.parquet").write_bytes(b"PAR1")
heights = np.random.default_rng(1).normal(size=(40, 50)) * 1e-8
np.savez(folder / "map.npz", heights=heights, pixel_size=1e-6)
radii = np.geomspace(1e-3, 10, 99)
slopes = np.random.default_rng(2).normal(size=(300, 2)) * 0.2
ndf, w = mf.StudentT(alpha=0.3, gamma=2.5), [0.6, 0.0, 0.8]
def plot():
    from microfacet import plot
def checks():
    from microfacet import _checks
def plugins():
    import microfacet.mitsuba
def report():
    import microfacet._report
calls = {
    "ufunc": lambda: mf.k0.Lambda(0.5, 0.3),
    "distribution": lambda: ndf.sample_visible(w, [0.1, 0.2, 0.3]),
    "own density": lambda: mf.RadialNDF(lambda r: np.exp(-(r**4)), alpha=0.3).Lambda(w),
    "samples of one": lambda: mf.RadialNDF((radii, np.exp(-(radii**2))), alpha=1.0),
    "conductor": lambda: mf.Conductor(ndf, [0.2, 1.0], [3.0, 2.0]).albedo(w),
    "dielectric": lambda: mf.Dielectric(ndf, 1.5).eval(w, w),
    "diffuse": lambda: mf.Diffuse(ndf, 0.5).eval(w, w, rng=1),
    "compensation": lambda: mf.KullaConty(mf.Conductor(ndf)).eval(w, w),
    "turquin": lambda: mf.Turquin(mf.Conductor(ndf)).eval(w, w),
    "fresnel": lambda: mf.fresnel_average(1.5),
    "fit": lambda: mf.fit(slopes, "beckmann"),
    "fit_table": lambda: mf.fit_table(mean_square_slopes=0.03),
    "compare": lambda: mf.compare([slopes, slopes], "beckmann"),
    "map": lambda: mf.roughness(mf.read_surface(folder / "map.npz").level().filtered(short=4e-6)),
    "scales": lambda: mf.fit_scales(mf.read_surface(folder / "map.npz"), [2], "beckmann"),
    "synthesize": lambda: mf.synthesize(ndf, (32, 32)),
    "arrays": lambda: mf.array_functions(ndf).D(w),
    "arrays of jax": lambda: mf.array_functions(ndf, "jax").D(w),
    "arrays of torch": lambda: mf.array_functions(ndf, "torch").D(w),
    "testing": lambda: mf.testing.sidak(0.01, 2),
    "families": mf.families,
    "include": mf.get_include,
    "terrain": mf.sample_terrain,
    "bake": lambda: mf.bake("energy", "ggx", alpha=1.0, cos_theta=2),
    "instrument": lambda: mf.read_surface(folder / "map.opd"),
    "image": lambda: mf.read_surface(folder / "map.png"),
    "normal map": lambda: mf.read_normal_map(folder / "map.png", "opengl"),
    "slopes": lambda: mf.read_slopes(folder / "slopes.parquet"),
    "plot": plot, "checks": checks, "plugins": plugins, "report": report,
}
said = {}
for name, call in calls.items():
    try:
        call()
    except (ImportError, mf.SurfaceError) as error:
        said[name] = [type(error).__name__, str(error)]
print(json.dumps(said))
"""
LACKS = {
    "terrain": "matplotlib",
    "bake": "xarray",
    "instrument": "SurfaceTopography",
    "image": "OpenImageIO",
    "normal map": "OpenImageIO",
    "slopes": "pyarrow",
    "plot": "matplotlib",
    "checks": "mpmath",
    "plugins": "mitsuba",
    "report": "matplotlib",
    "arrays of jax": "jax",
    "arrays of torch": "torch",
}


def test_public_functions_work_or_say_what_they_lack() -> None:
    done = python(CALLS, LIBRARIES)
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout)
    assert {name: re.search(r"needs? (\w+), which", text)[1] for name, (_, text) in said.items()} == LACKS
    for name, (kind, text) in said.items():
        assert kind in ("ImportError", "SurfaceError"), name
        assert re.search(r'pip install "\.\[(\w+)\]" in a checkout', text), name


COMMANDS = {
    "eval ggx D 0.5 --alpha 0.3": [["click"], ["rich"]],
    "families": [["click"], ["rich"]],
    "verify --id k0.marginal": [["mpmath"], ["rich"]],
    "report --quick --terrain": [["matplotlib"], ["jinja2"], ["latex2mathml"], ["mpmath"]],
    "render ggx --alpha 0.3": [["mitsuba"]],
    "gallery": [["mitsuba"], ["matplotlib"]],
    "fit --terrain --report page.html": [["matplotlib"], ["jinja2"]],
    "fit --terrain": [["matplotlib"]],
    "bake energy ggx --alpha 0.5 -o a.nc": [["xarray"], ["h5netcdf"]],
    "bake energy ggx --alpha 0.5 -o a.zarr": [["xarray"], ["zarr"]],
    "bake energy ggx --alpha 0.5 --cos 0.5 --walks 10 --dask tcp://127.0.0.1:9 -o a.nc": [["distributed"]],
    "bake energy ggx -o a.exr": [["OpenImageIO"]],
    "sample ggx --alpha 0.3 -o a.parquet": [["pyarrow"]],
}


@pytest.mark.parametrize(
    ("line", "without"), [(line, names) for line, all_ in COMMANDS.items() for names in all_]
)
def test_commands_say_what_they_lack(line: str, without: list[str], tmp_path: pathlib.Path) -> None:
    """Before they work for long: nothing else is said, and no file is written."""
    code = "from microfacet.__main__ import main; main()"
    done = python(code, without, *line.split(), cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, ""), done.stderr
    assert re.fullmatch(rf'microfacet: [^\n]* needs? {without[0]}, [^\n]*"\.\[\w+\]"[^\n]*\n', done.stderr)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "line",
    [
        "eval ggx D 0.5 --alpha 0.3",
        "families --json",
        "sample k0 --alpha 0.3 -n 3",
        "synthesize ggx --alpha 0.3 --shape 32 32 -o map.npz",
        "--version",
        "--help",
    ],
)
def test_the_command_needs_its_own_extra_alone(line: str, tmp_path: pathlib.Path) -> None:
    others = sorted(set(LIBRARIES) - {"click", "rich"})
    code = "from microfacet.__main__ import main; main()"
    done = python(code, others, *line.split(), cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout


def test_python_m_microfacet_is_the_command() -> None:
    program = [sys.executable, "-m", "microfacet"]
    done = subprocess.run([*program, "eval", "ggx", "D"], capture_output=True, text=True)
    assert done.returncode == 2
    assert "VALUES" in done.stderr
    done = subprocess.run([*program, "--help"], capture_output=True, text=True)
    assert done.stdout.startswith("Usage: microfacet [OPTIONS]")
    assert PROJECT["scripts"] == {"microfacet": "microfacet.__main__:main"}


@pytest.mark.parametrize(
    ("flag", "folder"), [("--include-dir", mf.get_include), ("--cmake-dir", mf.get_cmake_dir)]
)
def test_builds_find_the_package_without_the_command(flag: str, folder: Callable[[], str]) -> None:
    done = python("from microfacet.__main__ import main; main()", ["click", "rich"], flag)
    assert done.stdout == folder() + "\n", done.stderr
