// SPDX-License-Identifier: BSD-3-Clause
#include <exception>
#include <new>

#include "base/caller.hpp"
#include "base/error.hpp"
#include "python/bindings.hpp"

namespace slipfront::python {
namespace {

/// Raises an exception of slipfront.errors.
void raise(const char* name, const char* text) {
  const nb::object type = nb::module_::import_("slipfront.errors").attr(name);
  PyErr_SetString(type.ptr(), text);
}

void translate(const std::exception_ptr& thrown, void* /*payload*/) {
  try {
    std::rethrow_exception(thrown);
  } catch (const UserError& error) {
    raise("CaseError", error.what());
  } catch (const BlowUp& error) {
    raise("BlowUpError", error.what());
  } catch (const WriteError& error) {
    raise("WriteError", error.what());
  } catch (const Interrupted& error) {
    PyErr_SetString(PyExc_KeyboardInterrupt, error.what());
  } catch (const std::bad_alloc&) {
    PyErr_SetString(PyExc_MemoryError, "not enough memory; use larger elements");
  }
}

}  // namespace

void bind_errors(nb::module_& /*module*/) {
  nb::register_exception_translator(translate);
  set_caller(Caller::python);
}

}  // namespace slipfront::python
