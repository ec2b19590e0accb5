// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Bindings.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"

namespace explica::python {

namespace py = pybind11;

void bindCore(py::module_& m) {
  // Python's own families, so that `except ValueError` and `except OSError` work as users expect.
  static const py::exception<Error> error(m, "Error", PyExc_RuntimeError);
  static const py::exception<InvalidInput> invalid(m, "InvalidInput", PyExc_ValueError);
  static const py::exception<UsageError> usage(m, "UsageError", PyExc_ValueError);
  static const py::exception<IOError> io(m, "FileError", PyExc_OSError);
  static const py::exception<EnvironmentError> machine(m, "MachineError", PyExc_OSError);
  // The signature is pybind11's.
  // NOLINTNEXTLINE(performance-unnecessary-value-param)
  py::register_exception_translator([](std::exception_ptr thrown) {
    if (!thrown) return;
    try {
      std::rethrow_exception(thrown);
    } catch (const InvalidInput& e) {
      PyErr_SetString(invalid.ptr(), e.what());
    } catch (const UsageError& e) {
      PyErr_SetString(usage.ptr(), e.what());
    } catch (const IOError& e) {
      PyErr_SetString(io.ptr(), e.what());
    } catch (const EnvironmentError& e) {
      PyErr_SetString(machine.ptr(), e.what());
    } catch (const Error& e) {
      PyErr_SetString(error.ptr(), e.what());
    }
  });

  m.def("set_threads", &setThreadCount, py::arg("count"),
        "Limit every later call to `count` threads; 0 means all processors.");
  m.def("threads", &threadCount, "Number of threads that calls may use.");
}

}  // namespace explica::python
