// Graphs as Python's own dictionaries, lists and arrays.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <new>
#include <string_view>
#include <utility>
#include <vector>

#include "bindings/loop/numpy.hpp"
#include "microfacet/record/graph.hpp"

namespace microfacet::bindings {

using record::graph, record::kind, record::node, record::operation;

// Owns a reference; what could not be made is an exception.
class object {
 public:
  explicit object(PyObject* p) : p_(p) {
    if (p == nullptr) throw std::bad_alloc();
  }
  ~object() { Py_XDECREF(p_); }
  object(const object&) = delete;
  object& operator=(const object&) = delete;
  PyObject* get() const { return p_; }
  PyObject* release() { return std::exchange(p_, nullptr); }

 private:
  PyObject* p_;
};

template <class Values, class Convert>
PyObject* list_of(const Values& values, const Convert& convert) {
  object list(PyList_New(static_cast<Py_ssize_t>(values.size())));
  Py_ssize_t i = 0;
  for (const auto& x : values) PyList_SET_ITEM(list.get(), i++, object(convert(x)).release());
  return list.release();
}
inline PyObject* text(std::string_view s) {
  return PyUnicode_FromStringAndSize(s.data(), static_cast<Py_ssize_t>(s.size()));
}
inline PyObject* numbers(const std::vector<int>& ids) {
  return list_of(ids, [](int id) { return PyLong_FromLong(id); });
}
inline const char* name_of(kind k) {
  return k == kind::real ? "real" : k == kind::integer ? "integer" : "mask";
}

inline PyObject* arguments_of(const node& n) {
  const auto count =
      std::count_if(n.arguments.begin(), n.arguments.end(), [](int a) { return a != record::none; });
  // Results refer to their loop or branch alone.
  if (n.is(operation::branch_result)) return PyTuple_New(0);
  object tuple(PyTuple_New(count));
  for (Py_ssize_t i = 0; i < count; ++i)
    PyTuple_SET_ITEM(tuple.get(), i,
                     object(PyLong_FromLong(n.arguments[static_cast<std::size_t>(i)])).release());
  return tuple.release();
}
inline PyObject* value_of(const node& n) {
  switch (n.op) {
    case operation::literal:
      if (n.type == kind::mask) return PyBool_FromLong(n.value != 0);
      return n.type == kind::real ? PyFloat_FromDouble(n.value) : PyLong_FromLongLong(n.whole);
    case operation::input:
    case operation::table:
      return PyLong_FromLong(n.index);
    case operation::state:
      return PyLong_FromLong(n.part);
    case operation::loop_result:
    case operation::branch_result:
      return Py_BuildValue("(ii)", n.index, n.part);
    default:
      return Py_NewRef(Py_None);
  }
}
inline PyObject* loop_of(const record::loop& l) {
  return Py_BuildValue("{s:i,s:i,s:N,s:i,s:N,s:N,s:i}", "most", l.most, "parent", l.parent, "initial",
                       numbers(l.initial), "moving", l.moving, "state", numbers(l.state), "next",
                       numbers(l.next), "unsettled", l.unsettled);
}
inline PyObject* branch_of(const record::branch& b) {
  return Py_BuildValue("{s:i,s:N,s:N}", "mask", b.mask, "taken", numbers(b.taken), "other", numbers(b.other));
}
inline PyObject* table_of(const record::table& t, bool in_float64) {
  if (t.type == kind::real) {
    npy_intp size = static_cast<npy_intp>(t.values.size());
    object array(PyArray_SimpleNew(1, &size, in_float64 ? NPY_DOUBLE : NPY_FLOAT));
    for (npy_intp i = 0; i < size; ++i) {
      void* at = PyArray_GETPTR1(reinterpret_cast<PyArrayObject*>(array.get()), i);
      if (in_float64)
        *static_cast<double*>(at) = t.values[static_cast<std::size_t>(i)];
      else
        *static_cast<float*>(at) = static_cast<float>(t.values[static_cast<std::size_t>(i)]);
    }
    return array.release();
  }
  npy_intp size = static_cast<npy_intp>(t.wholes.size());
  object array(PyArray_SimpleNew(1, &size, in_float64 ? NPY_INT64 : NPY_INT32));
  for (npy_intp i = 0; i < size; ++i) {
    void* at = PyArray_GETPTR1(reinterpret_cast<PyArrayObject*>(array.get()), i);
    if (in_float64)
      *static_cast<std::int64_t*>(at) = t.wholes[static_cast<std::size_t>(i)];
    else
      *static_cast<std::int32_t*>(at) = static_cast<std::int32_t>(t.wholes[static_cast<std::size_t>(i)]);
  }
  return array.release();
}

inline PyObject* python_of(const graph& g) {
  const auto& n = g.nodes;
  return Py_BuildValue(
      "{s:s,s:N,s:N,s:N,s:N,s:N,s:N,s:N,s:N,s:N,s:N}", "real", g.in_float64 ? "float64" : "float32",
      "operation",
      list_of(n, [](const node& x) { return text(record::names[static_cast<std::size_t>(x.op)]); }), "type",
      list_of(n, [](const node& x) { return text(name_of(x.type)); }), "arguments", list_of(n, arguments_of),
      "value", list_of(n, value_of), "loop",
      list_of(n, [](const node& x) { return PyLong_FromLong(x.loop); }), "inputs", list_of(g.inputs, text),
      "results",
      list_of(g.results, [](const auto& r) { return Py_BuildValue("(si)", r.first.c_str(), r.second); }),
      "loops", list_of(g.loops, loop_of), "branches", list_of(g.branches, branch_of), "tables",
      list_of(g.tables, [&](const record::table& t) { return table_of(t, g.in_float64); }));
}

}  // namespace microfacet::bindings
