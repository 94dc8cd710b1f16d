"""Compilers and drivers that check printed text: looked for, run, and missed out loud.

Where one is missing, the test skips with the reason; it fails where MICROFACET_REQUIRE_EXPORT_TOOLS is set,
which says that the machine is complete.
"""

from __future__ import annotations

import ctypes
import importlib.util
import os
import shutil
import stat
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from limits import HANG

__all__ = ["compiled_c", "compiled_osl", "loaded", "missing", "nvcc", "program", "run", "slangc"]

FLAGS = ["-Wall", "-Wextra", "-Werror"]


def missing(what: str) -> Any:
    """Skip the test, or let it fail where everything must be there."""
    if os.environ.get("MICROFACET_REQUIRE_EXPORT_TOOLS"):
        pytest.fail(f"MICROFACET_REQUIRE_EXPORT_TOOLS is set, and {what} is missing")
    pytest.skip(f"{what} is missing")


def program(name: str) -> str:
    """The path of a program."""
    return shutil.which(name) or missing(name)


def _package(name: str) -> Path:
    """The folder of a Python package, which is not imported."""
    spec = importlib.util.find_spec(name)
    if spec is None or not spec.submodule_search_locations:
        missing(f"the package {name}")
        raise AssertionError
    return Path(next(iter(spec.submodule_search_locations)))


def slangc() -> str:
    """Slang's compiler: on the path, or the one of slangtorch, whose wheel forgets that it is a program."""
    found = shutil.which("slangc")
    if found:
        return found
    path = _package("slangtorch") / "bin" / "slangc"
    if not os.access(path, os.X_OK):
        path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return str(path)


def nvcc() -> str:
    """The CUDA compiler: on the path, or the one of NVIDIA's wheel."""
    found = shutil.which("nvcc") or next(map(str, _package("nvidia").glob("cu*/bin/nvcc")), None)
    return found or missing("nvcc")


def run(*command: object, **options: Any) -> str:
    """What a program prints; AssertionError with all of it where it fails."""
    result = subprocess.run(
        [str(word) for word in command], capture_output=True, text=True, timeout=HANG, **options
    )
    assert result.returncode == 0, result.stdout + result.stderr
    return result.stdout + result.stderr


def loaded(source: Path, library: Path, compiler: str, *flags: str) -> ctypes.CDLL:
    """A library from a source.

    It is linked without the flags: with -ffast-math it would flush subnormal numbers in the whole process.
    """
    compiled = library.with_suffix(".o")
    run(compiler, *FLAGS, *flags, "-c", "-fPIC", source, "-o", compiled)
    run(compiler, "-shared", compiled, "-o", library, "-lm")
    return ctypes.CDLL(str(library))


def compiled_osl(source: Path, to: Path) -> None:
    """Open Shading Language by oslc, or by Blender's Python package, which brings the compiler.

    Neither is in a registry in less than half a gigabyte, so a complete machine need not have it.
    """
    program = shutil.which("oslc")
    if program:
        run(program, "-o", to, source)
    elif importlib.util.find_spec("bpy"):
        # In a process of its own: what comes with Blender does not go well with what else a test loads.
        code = "import sys, bpy, _cycles; sys.exit(not _cycles.osl_compile(*sys.argv[1:]))"
        run(sys.executable, "-c", code, source, to)
    else:
        pytest.skip("a compiler of OSL (oslc, or the package bpy) is missing")


def compiled_c(folder: Path, source: str, compiler: str, *flags: str, ending: str = ".c") -> ctypes.CDLL:
    """A library of the functions run_NAME of `source`."""
    path = folder / f"cases{ending}"
    # Compilers do not ask for a use of every function of a file that is included.
    (folder / "cases.h").write_text(source, "utf-8")
    path.write_text('#include "cases.h"\n', "utf-8")
    return loaded(path, folder / "cases.so", program(compiler), *flags)


def called(library: ctypes.CDLL, name: str, rows: NDArray[np.float32], outputs: int) -> NDArray[np.float32]:
    """The results of run_NAME, one row a row."""
    results = np.empty((len(rows), outputs), np.float32)
    pointer = ctypes.POINTER(ctypes.c_float)
    getattr(library, f"run_{name}")(
        rows.ctypes.data_as(pointer), results.ctypes.data_as(pointer), ctypes.c_int(len(rows))
    )
    return results


def dispatched(code: str | bytes, rows: NDArray[np.float32], outputs: int) -> NDArray[np.float32]:
    """The results of a compute shader, WGSL or SPIR-V, on whatever Vulkan driver there is."""
    if importlib.util.find_spec("wgpu") is None:
        missing("the package wgpu")
    os.environ.setdefault("XDG_RUNTIME_DIR", "/tmp")
    import wgpu
    from wgpu.utils.compute import compute_with_buffers

    if not wgpu.gpu.enumerate_adapters_sync():
        missing("a Vulkan driver, such as lavapipe's")
    results = compute_with_buffers(
        {0: np.ascontiguousarray(rows)}, {1: (len(rows) * outputs, "f")}, code, n=-(-len(rows) // 64)
    )
    return np.frombuffer(results[1], np.float32).reshape(len(rows), outputs)


PAGE = r"""async ([source, width]) => {
  const gl = document.createElement('canvas').getContext('webgl2');
  if (!gl || !gl.getExtension('EXT_color_buffer_float')) return {error: 'no WebGL 2 with float textures'};
  const compile = (kind, source) => {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    const log = gl.getShaderInfoLog(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) || log.includes('WARNING')) throw new Error(log);
    return shader;
  };
  const vertices = `#version 300 es
void main() {
  gl_Position = vec4(vec2((gl_VertexID << 1) & 2, gl_VertexID & 2) * 2.0 - 1.0, 0, 1);
}`;
  const numbers = new Float32Array(await (await fetch('/rows')).arrayBuffer());
  const height = numbers.length / 12 / width, start = performance.now(), program = gl.createProgram();
  gl.attachShader(program, compile(gl.VERTEX_SHADER, vertices));
  gl.attachShader(program, compile(gl.FRAGMENT_SHADER, source));
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  gl.useProgram(program);
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, 3 * width, height, 0, gl.RGBA, gl.FLOAT, numbers);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
  const targets = [0, 1].map(i => {
    const target = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, target);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, width, height);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + i, gl.TEXTURE_2D, target, 0);
    return gl.COLOR_ATTACHMENT0 + i;
  });
  gl.drawBuffers(targets);
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.viewport(0, 0, width, 1);  // the driver compiles at the first draw
  gl.drawArrays(gl.TRIANGLES, 0, 3);
  gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.FLOAT, new Float32Array(4));  // gl.finish() does not wait
  const seconds = (performance.now() - start) / 1000;
  gl.viewport(0, 0, width, height);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
  const found = new Float32Array(8 * width * height);
  targets.forEach((target, i) => {
    gl.readBuffer(target);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, found.subarray(4 * width * height * i));
  });
  if (gl.getError()) throw new Error('WebGL error');
  await fetch('/results', {method: 'POST', body: found});
  return {seconds};
}"""


def drawn(
    sources: dict[str, str], rows: dict[str, NDArray[np.float32]], width: int = 64
) -> tuple[dict[str, NDArray[np.float32]], dict[str, float]]:
    """What fragment shaders give in a browser's WebGL 2, eight numbers a row, and seconds to compile each."""
    import browser

    if importlib.util.find_spec("playwright") is None:
        missing("the package playwright")
    path = browser.find() or missing("a browser")
    from playwright.sync_api import sync_playwright

    results, seconds, sent = {}, {}, {"rows": b"", "results": b""}

    def answer(route: Any) -> None:
        if route.request.method == "POST":
            sent["results"] = route.request.post_data_buffer
        body = sent["rows"] if route.request.url.endswith("rows") else b"<!doctype html>"
        route.fulfill(body=body, content_type="text/html")

    flags = ["--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking"]
    with sync_playwright() as tool:
        window = tool.chromium.launch(executable_path=path, args=[*flags, "--disable-sync"])
        try:
            page = window.new_page()
            page.route("**/*", answer)
            page.goto("http://localhost:9/")
            for name, source in sources.items():
                full = np.zeros((-(-len(rows[name]) // width) * width, 12), np.float32)
                full[: len(rows[name]), : rows[name].shape[1]] = rows[name]
                sent["rows"] = full.tobytes()
                found = page.evaluate(PAGE, [source, width])
                if "error" in found:
                    missing(found["error"])
                seconds[name] = found["seconds"]
                halves = np.frombuffer(sent["results"], np.float32).reshape(2, -1, 4)
                results[name] = np.concatenate(halves, axis=1)[: len(rows[name])]
        finally:
            window.close()
    return results, seconds
