"""The project as CMake sees it: a part of another project, and the package that a wheel carries."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import microfacet as mf

ROOT = Path(__file__).parents[1]
CMAKE = shutil.which("cmake")
pytestmark = pytest.mark.skipif(CMAKE is None, reason="there is no cmake")

PROGRAM = """
#include "microfacet/family/ggx.hpp"
int main() { return !(microfacet::ggx<double>().survival(1.0) == 0.5); }
"""
LISTS = """
cmake_minimum_required(VERSION 3.18)
project(parent LANGUAGES CXX)
enable_testing()
{microfacet}
add_executable(parent parent.cpp)
target_link_libraries(parent PRIVATE microfacet::microfacet)
add_test(NAME parent COMMAND parent)
install(TARGETS parent DESTINATION bin)
"""
FETCHED = """
include(FetchContent)
FetchContent_Declare(microfacet SOURCE_DIR "{root}")
FetchContent_MakeAvailable(microfacet)
"""


def run(*command: object) -> str:
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def parent(folder: Path, microfacet: str, *options: str) -> Path:
    """A project that needs microfacet, configured."""
    folder.mkdir()
    (folder / "parent.cpp").write_text(PROGRAM)
    (folder / "CMakeLists.txt").write_text(LISTS.format(microfacet=microfacet.format(root=ROOT.as_posix())))
    run(CMAKE, "-S", folder, "-B", folder / "build", *options)
    return folder / "build"


def installed(prefix: Path) -> list[str]:
    return sorted(str(path.relative_to(prefix)) for path in prefix.rglob("*") if path.is_file())


@pytest.mark.parametrize("how", ['add_subdirectory("{root}" microfacet)', FETCHED])
@pytest.mark.parametrize("options", [(), ("-DSKBUILD=2", "-DSKBUILD_PROJECT_NAME=parent")])
def test_a_part_of_another_project_is_a_target_alone(
    tmp_path: Path, how: str, options: tuple[str, ...]
) -> None:
    build = parent(tmp_path / "parent", how, *options)
    targets = run(CMAKE, "--build", build, "--target", "help")
    for name in ("avx2", "avx512", "baseline", "processor"):
        assert name not in targets
    run(CMAKE, "--build", build)
    run(build / "parent")
    run(CMAKE, "--install", build, "--prefix", tmp_path / "prefix")
    assert installed(tmp_path / "prefix") == ["bin/parent"]


def test_a_parent_may_install_it(tmp_path: Path) -> None:
    how = 'add_subdirectory("{root}" microfacet)'
    build = parent(tmp_path / "parent", how, "-DMICROFACET_INSTALL=ON", "-DSKBUILD=2")
    run(CMAKE, "--install", build, "--prefix", tmp_path / "prefix", "--component", "microfacet")
    files = installed(tmp_path / "prefix")
    assert {"include/microfacet/smith/ndf.hpp", "share/cmake/microfacet/microfacet-config.cmake"} <= {*files}


def test_a_wheel_carries_the_package(tmp_path: Path) -> None:
    # As scikit-build-core configures it, without the kernels, which take minutes.
    wheel = tmp_path / "site-packages"
    options = ("-DSKBUILD=2", f"-DPython_EXECUTABLE={sys.executable}", "-DMICROFACET_INSTRUCTION_SETS=all")
    run(CMAKE, "-S", ROOT, "-B", tmp_path / "wheel", *options)
    run(CMAKE, "--install", tmp_path / "wheel", "--prefix", wheel, "--component", "microfacet")
    folder = wheel / "microfacet" / "share" / "cmake" / "microfacet"
    build = parent(tmp_path / "parent", "find_package(microfacet REQUIRED)", f"-Dmicrofacet_DIR={folder}")
    run(CMAKE, "--build", build)
    run(build / "parent")
    assert str(wheel / "microfacet" / "include") in run(CMAKE, "--build", build, "--clean-first", "--verbose")
    targets = run(CMAKE, "--build", tmp_path / "wheel", "--target", "help")
    assert "microfacet_baseline" in targets
    assert "microfacet_processor" in targets


def test_the_installed_package_is_found(tmp_path: Path) -> None:
    folder = run(sys.executable, "-c", "from microfacet.cli import main; main()", "--cmake-dir").strip()
    assert folder == mf.get_cmake_dir()
    headers = run(sys.executable, "-c", "from microfacet.cli import main; main()", "--include-dir").strip()
    assert headers == mf.get_include()
    build = parent(tmp_path / "parent", "find_package(microfacet REQUIRED)", f"-Dmicrofacet_DIR={folder}")
    run(CMAKE, "--build", build)
    run(build / "parent")
