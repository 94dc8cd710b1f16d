// microfacet._core.processor: which of the builds of the kernels this processor runs.
#define PY_SSIZE_T_CLEAN
#include <Python.h>

namespace {

PyObject* instruction_sets(PyObject*, PyObject*) {
#if defined(__x86_64__)
  __builtin_cpu_init();
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  const bool avx512 = avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512cd") &&
                      __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
                      __builtin_cpu_supports("avx512vl");
  if (avx512) return Py_BuildValue("(sss)", "baseline", "avx2", "avx512");
  if (avx2) return Py_BuildValue("(ss)", "baseline", "avx2");
#endif
  return Py_BuildValue("(s)", "baseline");
}

PyMethodDef methods[] = {{"instruction_sets", instruction_sets, METH_NOARGS,
                          "Names of the instruction sets that this processor has, the best one last."},
                         {nullptr, nullptr, 0, nullptr}};

PyModuleDef definition{PyModuleDef_HEAD_INIT,
                       "microfacet._core.processor",
                       "What the processor can do.",
                       -1,
                       methods,
                       nullptr,
                       nullptr,
                       nullptr,
                       nullptr};

}  // namespace

PyMODINIT_FUNC PyInit_processor() { return PyModule_Create(&definition); }
