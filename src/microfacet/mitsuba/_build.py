"""From the C++ sources of the plugins to a shared library for one variant, compiled once and cached."""

from __future__ import annotations

import hashlib
import json
import os
import platform
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path

import drjit
import mitsuba
import nanobind

import microfacet as mf
from microfacet._core.processor import instruction_sets
from microfacet.mitsuba import _cache, _check
from microfacet.mitsuba._progress import progress

__all__ = ["Compiler", "compile_flags", "find_compiler", "key", "library"]

SOURCES = Path(__file__).parent / "plugin"


@dataclass(frozen=True)
class Compiler:
    """A command that compiles C++, and what it says about itself."""

    command: tuple[str, ...]
    version: str

    @property
    def is_clang(self) -> bool:
        return "clang" in self.version


def find_compiler() -> Compiler:
    """$CXX, or g++, or c++."""
    stated = os.environ.get("CXX")
    for words in [shlex.split(stated)] if stated else [["g++"], ["c++"]]:
        if words and shutil.which(words[0]):
            try:
                said = subprocess.run([*words, "--version"], capture_output=True, text=True, check=True)
            except (OSError, subprocess.CalledProcessError):
                raise ImportError(f"the compiler {words[0]!r} does not run: set CXX to g++") from None
            return Compiler(tuple(words), said.stdout)
    if stated:
        raise ImportError(f"CXX names the compiler {stated!r}, which is not there: set it to g++")
    raise ImportError(
        "microfacet.mitsuba compiles its plugins and found no C++ compiler: install g++ 11 or newer "
        "(Debian: apt install g++) or name one in CXX"
    )


def instruction_set() -> tuple[str, ...]:
    """The option that makes vectors lie in memory as in Mitsuba's own libraries.

    Those are compiled for SSE 4.2 at least. Without that a Vector3f has another layout: all compiles, and
    scalar variants render a wrong image.
    """
    if platform.machine() not in ("x86_64", "AMD64"):
        return ()
    return ("-march=x86-64-v3",) if "avx2" in instruction_sets() else ("-march=x86-64-v2",)


def compile_flags(variant: str) -> list[str]:
    packages = [_folder(mitsuba), _folder(drjit)]
    nanobind_headers = Path(nanobind.include_dir())
    theirs = [
        *(folder / "include" for folder in packages),
        nanobind_headers,
        nanobind_headers.parent / "ext" / "robin_map" / "include",
    ]
    return [
        # Variants of Dr.Jit run this code only to record kernels: -O1 compiles a third faster.
        "-O2" if variant.startswith("scalar") else "-O1",
        *("-std=c++20", "-fPIC", "-fvisibility=hidden", "-fno-strict-aliasing", "-DNDEBUG"),
        # as the compiled core: contraction would undo sums of two numbers
        *("-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math"),
        *instruction_set(),
        f"-DMICROFACET_VARIANT={variant}",
        f"-I{mf.get_include()}",
        *(f"-isystem{folder}" for folder in theirs),
    ]


def link_flags() -> list[str]:
    folders = [_folder(mitsuba), _folder(drjit)]
    libraries = ("mitsuba", "drjit-core", "drjit-extra", "nanothread")
    return [
        "-shared",
        *(f"-L{folder}" for folder in folders),
        *(f"-Wl,-rpath,{folder}" for folder in folders),
        *(f"-l{name}" for name in libraries),
    ]


def _folder(package: object) -> Path:
    # Importing Mitsuba replaces the module by another without __file__; __path__ it keeps.
    return Path(next(iter(package.__path__))).resolve()  # type: ignore[attr-defined]


def key(compiler: Compiler, variant: str) -> str:
    """Changes with whatever the library, or the verdict on it, depends on."""
    versions = {"mitsuba": mitsuba.__version__, "drjit": drjit.__version__, "nanobind": nanobind.__version__}
    stated = [
        compiler.command,
        compiler.version,
        compile_flags(variant),
        link_flags(),
        {**versions, "microfacet": mf.__version__},
    ]
    digest = hashlib.sha256(json.dumps(stated).encode())
    headers = Path(mf.get_include())
    for folder, path in (
        *((SOURCES, path) for path in sorted(SOURCES.rglob("*.[ch]pp"))),
        *((headers, path) for path in sorted((headers / "microfacet").rglob("*.hpp"))),
        (_check.COMPARISON.parent, _check.COMPARISON),
    ):
        content = path.read_bytes()
        digest.update(f"{path.relative_to(folder)} {len(content)}\n".encode())
        digest.update(content)
    return digest.hexdigest()[:20]


def library(variant: str) -> Path:
    """The path of a library of the plugins that has passed its check, from the cache where it is."""
    compiler = find_compiler()
    if compiler.is_clang and not variant.startswith("scalar") and sys.platform != "darwin":
        raise ImportError(
            f"{shlex.join(compiler.command)} is clang, whose {variant} plugins abort beside Mitsuba's "
            "libraries, which GCC made: set CXX to g++"
        )
    path = _cache.library_in(_cache.directory(), variant, key(compiler, variant))
    objection = _cache.read_record(path)
    if objection is None:
        with _cache.locked(variant) as folder:
            objection = _cache.read_record(path)  # another process may have been quicker
            if objection is None:
                begin = time.monotonic()
                progress(f"compiling the Mitsuba plugins for {variant} (once, about 20 s of processor time)")
                _compile(compiler, variant, path)
                progress(f"comparing the plugins for {variant} with Mitsuba's own")
                objection = _check.objection(path, variant, compiler.command[0])
                progress(
                    f"the plugins for {variant} took {time.monotonic() - begin:.0f} s; {folder} keeps them"
                )
                _cache.write_record(path, objection)
                _cache.prune(folder)
    if objection:
        raise ImportError(objection)
    return path


def _compile(compiler: Compiler, variant: str, target: Path) -> None:
    """Compile all sources side by side, link, and put the library in its place at once."""
    sources = sorted(SOURCES.glob("*.cpp"))
    flags = compile_flags(variant)
    with tempfile.TemporaryDirectory(dir=target.parent, prefix=_cache.scratch_prefix) as scratch:
        objects = [Path(scratch) / f"{source.stem}.o" for source in sources]

        def compile_one(source: Path, made: Path) -> None:
            arguments = [*flags, "-c", str(source), "-o", str(made)]
            _run(compiler, arguments, f"compile {source.name} for {variant}")

        with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
            jobs = [pool.submit(compile_one, *each) for each in zip(sources, objects, strict=True)]
            for number, job in enumerate(as_completed(jobs), 1):
                job.result()
                progress(f"  {number} of {len(jobs)} sources compiled")
        linked = Path(scratch) / target.name
        arguments = [*map(str, objects), *link_flags(), "-o", str(linked)]
        _run(compiler, arguments, f"link the plugins for {variant}")
        linked.chmod(0o755)  # whatever the umask: what others can write is not loaded
        os.replace(linked, target)


def _run(compiler: Compiler, arguments: list[str], what: str) -> None:
    command = [*compiler.command, *arguments]
    done = subprocess.run(command, capture_output=True, text=True, errors="replace")
    if done.returncode != 0:
        lines = [line for line in done.stderr.splitlines() if line.strip()]
        errors = [line for line in lines if "error" in line or "undefined" in line]
        said = "\n".join((errors or lines)[-5:]) or f"status {done.returncode}"
        raise ImportError(f"{shlex.join(compiler.command)} could not {what}: {said}")
