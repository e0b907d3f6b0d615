// SPDX-License-Identifier: MIT
//
// Tables of BRDFs, which shlight/_tables.py samples, reads and checks.
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include "arguments.h"
#include "bindings.h"
#include "gil.h"
#include "shlight/bsdf.h"
#include "shlight/lobe_table.h"
#include "whole_objects.h"

namespace shlight::python {
namespace {

using TableAxes = std::array<std::pair<std::vector<double>, double>, 4>;  // angles and period
using WholeTable = std::tuple<bool, TableAxes, int, Array<float>, std::vector<float>>;

std::shared_ptr<LobeTable> table_from(bool half_vector, const TableAxes& axes, int channels,
                                      const Array<float>& entries, std::vector<float> sampling_errors) {
    const auto axis = [&](std::size_t k) { return TableAxis(axes[k].first, axes[k].second); };
    const std::array<TableAxis, 4> own = {axis(0), axis(1), axis(2), axis(3)};
    const auto all = values(entries);
    std::vector<float> copy(all.begin(), all.end());
    const GilReleased release;
    return std::make_shared<LobeTable>(half_vector ? TableAngles::half_vector : TableAngles::directions, own, channels,
                                       std::move(copy), std::move(sampling_errors));
}

WholeTable whole_table(const LobeTable& table) {
    TableAxes axes;
    for (std::size_t k = 0; k < 4; ++k) {
        axes[k] = {table.axes()[k].angles(), table.axes()[k].period()};
    }
    Array<float> entries(static_cast<py::ssize_t>(table.entries().size()));
    std::copy(table.entries().begin(), table.entries().end(), entries.mutable_data());
    return {table.angles() == TableAngles::half_vector, axes, table.channels(), entries, table.sampling_errors()};
}

/// f of directions (n, 3), whose rows are unit and above the horizon: (n, channels).
Array<double> values_at(const LobeTable& table, const Array<double>& wi, const Array<double>& wo) {
    const auto lights = vectors("wi", wi);
    const auto views = vectors("wo", wo);
    Array<double> out({static_cast<py::ssize_t>(lights.size()), static_cast<py::ssize_t>(table.channels())});
    double* data = out.mutable_data();
    for (std::size_t i = 0; i < lights.size(); ++i) {
        for (int channel = 0; channel < table.channels(); ++channel) {
            *data++ = table.value(lights[i], views[i], channel);
        }
    }
    return out;
}

}  // namespace

void bind_tables(py::module_& m) {
    py::class_<LobeTable, std::shared_ptr<LobeTable>> type(m, "LobeTable", without_constructor());
    define_pickling(type, &whole_table, [](const WholeTable& state) { return std::apply(&table_from, state); });
    type.def("values", &values_at, py::arg("wi").noconvert(), py::arg("wo").noconvert())
        .def_property_readonly("is_isotropic", &LobeTable::is_isotropic)
        .def(
            "with_sampling_errors",
            [](const LobeTable& table, std::vector<float> errors) {
                return std::make_shared<LobeTable>(table.with_sampling_errors(std::move(errors)));
            },
            py::arg("errors"))
        .def(
            "bsdf",
            [](const std::shared_ptr<LobeTable>& table, int order) {
                const GilReleased release;
                return Bsdf::table(table, order);
            },
            py::arg("order"));
    m.def("lobe_table", &table_from, py::arg("half_vector"), py::arg("axes"), py::arg("channels"),
          py::arg("entries").noconvert(), py::arg("sampling_errors"));
}

}  // namespace shlight::python
