// SPDX-License-Identifier: MIT
#include "arguments.h"

#include <cstring>
#include <limits>

#include "bindings.h"

namespace shlight::python {

namespace {

[[noreturn]] void refuse_type(const char* name, const char* expected, const py::handle& value) {
    if (PyErr_Occurred() != nullptr && PyErr_ExceptionMatches(PyExc_Exception) == 0) {
        throw py::error_already_set();  // an interrupt
    }
    PyErr_Clear();
    throw std::invalid_argument(std::string(name) + " must be " + expected + ", got " + Py_TYPE(value.ptr())->tp_name);
}

/// Silences numpy's warnings about numbers out of range. Signals may interrupt Python code anywhere, numpy's too, so
/// that what was set is set until it stays, and an interrupt meanwhile comes afterwards.
class QuietConversion {
  public:
    QuietConversion()
        : set_(py::module_::import("numpy").attr("seterr")), before_(py::module_::import("numpy").attr("geterr")()) {
        try {
            set_(py::arg("all") = "ignore");
        } catch (...) {
            restore();
            throw;
        }
    }
    ~QuietConversion() { restore(); }
    QuietConversion(const QuietConversion&) = delete;
    QuietConversion& operator=(const QuietConversion&) = delete;

  private:
    void restore() const {
        constexpr int kMostTries = 100;
        const py::error_scope error;
        bool interrupted = false;
        for (int i = 0; i < kMostTries; ++i) {
            if (PyObject* const set = PyObject_Call(set_.ptr(), py::tuple().ptr(), before_.ptr())) {
                Py_DECREF(set);
                break;
            }
            interrupted = interrupted || PyErr_ExceptionMatches(PyExc_KeyboardInterrupt) != 0;
            PyErr_Clear();
        }
        if (interrupted) {
            PyErr_SetInterrupt();
        }
    }

    py::object set_, before_;
};

struct Integer {
    std::int64_t value;
    int overflow;  // sign of a number that does not fit, or 0
};

Integer integer(const char* name, const py::handle& value) {
    const bool indexable = PyIndex_Check(value.ptr()) != 0 && PyBool_Check(value.ptr()) == 0;
    const auto index = py::reinterpret_steal<py::object>(indexable ? PyNumber_Index(value.ptr()) : nullptr);
    if (!index) {
        refuse_type(name, "an integer", value);
    }
    int overflow = 0;
    const std::int64_t number = PyLong_AsLongLongAndOverflow(index.ptr(), &overflow);
    return {number, overflow};
}

[[noreturn]] void refuse_range(const char* name, const std::string& range, const Integer& given) {
    const std::string got = given.overflow == 0  ? std::to_string(given.value)
                            : given.overflow > 0 ? "a number above 2⁶³"
                                                 : "a number below -2⁶³";
    throw std::invalid_argument(std::string(name) + " must be " + range + ", got " + got);
}

}  // namespace

template <class T>
AnyArray<T> array_from(const char* name, const py::handle& value, const char* kinds) {
    const QuietConversion quiet;
    const char* const expected =
        std::strchr(kinds, 'f') != nullptr ? "an array of real numbers" : "an array of integers";
    py::array raw;
    try {
        const bool has_dlpack_alone = py::hasattr(value, "__dlpack__") && !py::hasattr(value, "__array__");
        raw = py::array(has_dlpack_alone ? py::module_::import("numpy").attr("from_dlpack")(value)
                                         : py::reinterpret_borrow<py::object>(value));
    } catch (const py::error_already_set& error) {
        if (!error.matches(PyExc_Exception)) {
            throw;  // an interrupt
        }
        refuse_type(name, expected, value);
    }
    if (std::strchr(kinds, raw.dtype().kind()) == nullptr) {
        refuse_type(name, expected, value);
    }
    return AnyArray<T>(raw);
}

template AnyArray<float> array_from(const char* name, const py::handle& value, const char* kinds);
template AnyArray<double> array_from(const char* name, const py::handle& value, const char* kinds);
template AnyArray<std::int64_t> array_from(const char* name, const py::handle& value, const char* kinds);

double real_from(const char* name, const py::handle& value) {
    if (PyFloat_Check(value.ptr()) != 0) {
        return PyFloat_AS_DOUBLE(value.ptr());
    }
    if (PyLong_Check(value.ptr()) != 0) {
        const double number = PyLong_AsDouble(value.ptr());
        if (PyErr_Occurred() == nullptr) {
            return number;
        }
        PyErr_Clear();
        const bool negative = py::reinterpret_borrow<py::int_>(value) < py::int_(0);
        return negative ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
    }
    // numpy converts and rejects without warnings, for example complex numbers.
    if (py::hasattr(value, "dtype")) {
        const AnyArray<double> array = array_from<double>(name, value);
        if (array.ndim() != 0) {
            refuse_type(name, "a number", value);
        }
        return *array.data();
    }
    const PyNumberMethods* methods = Py_TYPE(value.ptr())->tp_as_number;
    if (methods == nullptr || methods->nb_float == nullptr) {
        refuse_type(name, "a number", value);
    }
    const double number = PyFloat_AsDouble(value.ptr());
    if (PyErr_Occurred() != nullptr) {
        refuse_type(name, "a number", value);
    }
    return number;
}

std::int64_t integer_from(const char* name, const py::handle& value, std::int64_t least, std::int64_t largest) {
    const Integer given = integer(name, value);
    if (given.overflow != 0 || given.value < least || given.value > largest) {
        refuse_range(name, std::to_string(least) + " … " + std::to_string(largest), given);
    }
    return given.value;
}

int int_from(const char* name, const py::handle& value) {
    const Integer given = integer(name, value);
    if (given.overflow != 0 || given.value != static_cast<int>(given.value)) {
        refuse_range(name, "far nearer to 0", given);
    }
    return static_cast<int>(given.value);
}

bool flag_from(const char* name, const py::handle& value) {
    if (PyBool_Check(value.ptr()) == 0 && !py::isinstance(value, py::module_::import("numpy").attr("bool_"))) {
        refuse_type(name, "True or False", value);
    }
    return value.cast<bool>();
}

Rgb color_from(const char* name, const py::handle& value) {
    const AnyArray<float> array = array_from<float>(name, value);
    if (array.ndim() == 0) {
        return Rgb(*array.data());
    }
    if (array.ndim() == 1 && array.size() == 3) {
        return vectors(name, array)[0];
    }
    throw std::invalid_argument(std::string(name) + " must be a number or have shape (3,)");
}

/// Used by the batch functions, whose arguments Python checks before broadcasting.
void bind_arguments(py::module_& m) {
    m.def("checked_number",
          [](const std::string& name, const py::object& value) { return real_from(name.c_str(), value); });
    m.def("checked_integer", [](const std::string& name, const py::object& value, std::int64_t least,
                                std::int64_t largest) { return integer_from(name.c_str(), value, least, largest); });
    m.def("checked_flag",
          [](const std::string& name, const py::object& value) { return flag_from(name.c_str(), value); });
    m.def("converted_array", [](const std::string& name, const py::object& value, bool single) -> py::array {
        if (single) {
            return array_from<float>(name.c_str(), value);
        }
        return array_from<double>(name.c_str(), value);
    });
}

}  // namespace shlight::python
