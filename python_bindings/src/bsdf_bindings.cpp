// SPDX-License-Identifier: MIT
#include <pybind11/operators.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "arguments.h"
#include "base/unit_direction.h"
#include "bindings.h"
#include "shlight/bsdf.h"
#include "shlight/plain_fit.h"
#include "whole_objects.h"

namespace shlight::python {
namespace {

bool is_grey(const Bsdf& bsdf) {
    for (const Lobe& lobe : bsdf.lobes()) {
        if (lobe.color.x != lobe.color.y || lobe.color.y != lobe.color.z) {
            return false;
        }
    }
    return true;
}

void check_cosine(double cosine) {
    if (!(cosine >= 0 && cosine <= 1)) {
        throw std::invalid_argument("cos_theta_o must lie in [0, 1]");
    }
}

std::shared_ptr<const PlainFit> fit_of(const Lobe& lobe) {
    if (is_mirror(lobe.shape)) {
        throw std::invalid_argument("a perfect mirror (roughness below 0.003) has no coefficients");
    }
    return plain_fit(lobe.shape);
}

using LobeFits = std::vector<std::pair<Lobe, std::shared_ptr<const PlainFit>>>;

LobeFits fits_of(const Bsdf& bsdf) {
    LobeFits fits;
    for (const Lobe& lobe : bsdf.lobes()) {
        fits.emplace_back(lobe, fit_of(lobe));
    }
    return fits;
}

/// Coefficients at one view angle: `channels` rows of order² numbers, which are 0 where m < 0.
void write_coefficients(const LobeFits& lobes, double cosine, int order, int channels, float* out) {
    const int row = coefficient_count(order);
    std::fill_n(out, channels * row, 0.0F);
    std::vector<float> terms(static_cast<std::size_t>(cosine_count(order)));
    for (const auto& [lobe, fit] : lobes) {
        const Rgb scale = lobe.scale(static_cast<float>(cosine));
        fit->coefficients(cosine, order, terms.data());
        for (int channel = 0; channel < channels; ++channel) {
            for (int l = 0; l < order; ++l) {
                for (int m = 0; m <= l; ++m) {
                    out[channel * row + coefficient_index(l, m)] +=
                        scale[channel] * terms[static_cast<std::size_t>(cosine_index(l, m))];
                }
            }
        }
    }
}

Array<float> coefficients(const Bsdf& bsdf, const py::object& views, const py::object& bands) {
    const AnyArray<double> cos_theta_o = array_from<double>("cos_theta_o", views);
    const int order = int_from("order", bands);
    check_order(order);
    const int channels = is_grey(bsdf) ? 1 : 3;
    std::vector<py::ssize_t> added{coefficient_count(order)};
    if (channels == 3) {
        added.insert(added.begin(), 3);
    }
    Array<float> out(shape_with(cos_theta_o, 0, added));
    const LobeFits lobes = fits_of(bsdf);
    float* data = out.mutable_data();
    for (const double cosine : values(cos_theta_o)) {
        check_cosine(cosine);
        write_coefficients(lobes, cosine, order, channels, data);
        data += channels * coefficient_count(order);
    }
    return out;
}

/// Upper bound of the residual: errors of lobes are added, since they may have the same sign.
double residual_at(const LobeFits& lobes, double cosine, int order) {
    check_cosine(cosine);
    double error = 0;
    double squares = 0;  // lower bound of the squared norm, without the positive overlaps of lobes
    for (const auto& [lobe, fit] : lobes) {
        const Rgb scale = lobe.scale(static_cast<float>(cosine));
        const double size = std::max({scale.x, scale.y, scale.z}) * fit->norm(cosine);
        error += size * fit->residual(cosine, order);
        squares += size * size;
    }
    return squares > 0 ? error / std::sqrt(squares) : 0;
}

Array<double> residual(const Bsdf& bsdf, const py::object& views, const py::object& bands) {
    const AnyArray<double> cos_theta_o = array_from<double>("cos_theta_o", views);
    const int order = int_from("order", bands);
    check_order(order);
    Array<double> out(shape_with(cos_theta_o, 0, {}));
    const LobeFits lobes = fits_of(bsdf);
    double* data = out.mutable_data();
    for (const double cosine : values(cos_theta_o)) {
        *data++ = residual_at(lobes, cosine, order);
    }
    return out;
}

AnyArray<double> directions_from(const char* name, const py::object& value) {
    AnyArray<double> array = array_from<double>(name, value);
    vectors(name, array);  // which checks the shape
    return array;
}

Array<double> evaluate(const Bsdf& bsdf, const py::object& wi, const py::object& wo) {
    const AnyArray<double> lights = directions_from("wi", wi);
    const AnyArray<double> views = directions_from("wo", wo);
    py::sequence both;
    try {
        both = py::module_::import("numpy").attr("broadcast_arrays")(lights, views);
    } catch (const py::error_already_set& error) {
        if (!error.matches(PyExc_ValueError)) {
            throw;
        }
        throw std::invalid_argument("wi and wo have leading axes that do not broadcast");
    }
    const AnyArray<double> incoming(py::reinterpret_borrow<py::object>(both[0]));
    const AnyArray<double> outgoing(py::reinterpret_borrow<py::object>(both[1]));
    const auto i = vectors("wi", incoming);
    const auto o = vectors("wo", outgoing);
    const bool grey = is_grey(bsdf);
    Array<double> out(shape_with(incoming, 1, grey ? std::vector<py::ssize_t>{} : std::vector<py::ssize_t>{3}));
    double* data = out.mutable_data();
    for (std::size_t k = 0; k < i.size(); ++k) {
        const Rgb f = bsdf.evaluate(unit_direction(i[k], "wi"), unit_direction(o[k], "wo"));
        for (int channel = 0; channel < (grey ? 1 : 3); ++channel) {
            *data++ = static_cast<double>(f[channel]);
        }
    }
    return out;
}

Bsdf scaled(const Bsdf& bsdf, const py::object& factor) {
    return bsdf.scaled(color_from("factor", factor));
}

/// Whether a value is an expression of shlight.nodes: a number, a vector or a colour.
bool is_expression(const py::handle& value) {
    return py::hasattr(value, "step") || py::hasattr(value, "as_number");
}

py::object shader_function(const char* name) {
    return py::module_::import("shlight.nodes").attr(name);
}

py::object lambert(const py::object& albedo) {
    return is_expression(albedo) ? shader_function("lambert")(albedo)
                                 : py::cast(Bsdf::lambert(color_from("albedo", albedo)));
}

Bsdf constant_ggx(const py::object& roughness, const py::object& f0, const py::object& ior) {
    const auto width = static_cast<float>(real_from("roughness", roughness));
    const Rgb head_on = color_from("f0", f0);
    const double index = ior.is_none() ? 0 : real_from("ior", ior);
    if (!ior.is_none() && !(index > 1)) {  // 0 stands for None
        throw std::invalid_argument("ior must be finite and greater than 1");
    }
    const py::gil_scoped_release release;
    return Bsdf::ggx(width, head_on, index);
}

py::object ggx(const py::object& roughness, const py::object& f0, const py::object& ior) {
    return is_expression(roughness) || is_expression(f0) ? shader_function("ggx")(roughness, f0, py::arg("ior") = ior)
                                                         : py::cast(constant_ggx(roughness, f0, ior));
}

Bsdf layer(const py::object& top, const py::object& base) {
    return Bsdf::layer(object_from<Bsdf>("top", top, "Bsdf"), object_from<Bsdf>("base", base, "Bsdf"));
}

std::string described(const LobeShape& shape) {
    const auto* const ggx = std::get_if<GgxShape>(&shape);
    if (ggx == nullptr) {
        return std::holds_alternative<LambertShape>(shape) ? "lambert" : "lobe";
    }
    constexpr std::array kCurves = {"", ", fresnel='schlick'", ", fresnel='dielectric'", ", fresnel='dip'"};
    std::ostringstream text;
    text.precision(3);
    text << "ggx(roughness=" << std::sqrt(ggx->alpha) << kCurves.at(static_cast<std::size_t>(ggx->fresnel)) << ")";
    return text.str();
}

/// The lobes, each times its colour; a lobe under another is dimmed by what that reflects at the view.
std::string repr(const Bsdf& bsdf) {
    std::ostringstream text;
    text.precision(3);
    const char* before = "Bsdf(";
    for (const Lobe& lobe : bsdf.lobes()) {
        const Rgb& c = lobe.color;
        text << before << described(lobe.shape) << " * (" << c.x << ", " << c.y << ", " << c.z << ")"
             << (lobe.weight ? " under a layer" : "");
        before = " + ";
    }
    return bsdf.lobes().empty() ? "Bsdf(black)" : text.str() + ")";
}

using GgxState = std::tuple<double, int, double>;  // alpha, Fresnel, ior
using LobeState = std::tuple<std::optional<GgxState>, std::array<float, 3>, std::optional<std::vector<float>>>;

std::vector<LobeState> state_of(const Bsdf& bsdf) {
    std::vector<LobeState> state;
    for (const Lobe& lobe : bsdf.lobes()) {
        std::optional<GgxState> shape;
        if (const auto* ggx = std::get_if<GgxShape>(&lobe.shape)) {
            shape = {ggx->alpha, static_cast<int>(ggx->fresnel), ggx->ior};
        }
        state.push_back({shape,
                         {lobe.color.x, lobe.color.y, lobe.color.z},
                         lobe.weight ? std::optional(lobe.weight->nodes()) : std::nullopt});
    }
    return state;
}

LobeShape shape_from(const std::optional<GgxState>& state) {
    if (!state) {
        return LambertShape{};
    }
    const auto [alpha, fresnel, ior] = *state;
    if (!(alpha >= 0 && alpha <= 1 && ior > 1 && std::isfinite(ior)) || fresnel < static_cast<int>(Fresnel::one) ||
        fresnel > static_cast<int>(Fresnel::dielectric)) {
        throw std::invalid_argument("state does not describe a lobe");
    }
    return GgxShape{alpha, static_cast<Fresnel>(fresnel), ior};
}

Bsdf bsdf_from(const std::vector<LobeState>& state) {
    Bsdf sum;
    for (const auto& [shape, color, nodes] : state) {
        sum = sum + Bsdf::lobe(shape_from(shape), {color[0], color[1], color[2]},
                               nodes ? std::make_shared<const ViewWeight>(*nodes) : nullptr);
    }
    return sum;
}

constexpr const char* kDoc =
    R"(A material: a sum of coloured lobes f·cos in the shading frame (z is the surface normal).

Bsdfs can be added and multiplied by a number or an RGB colour. They are immutable. Colours are 0 … 1e10.)";

/// The first line is the signature, as pybind11 writes those of other functions: that of shlight.nodes.principled.
constexpr const char* kPrincipledDoc =
    R"(principled(base_color=(0.8, 0.8, 0.8), *, metallic=0.0, roughness=0.5, ior=1.5, alpha=1.0, diffuse_roughness=0.0, )"
    R"(specular_ior_level=0.5, specular_tint=(1.0, 1.0, 1.0), coat_weight=0.0, coat_roughness=0.03, coat_ior=1.5, )"
    R"(coat_tint=(1.0, 1.0, 1.0), coat_normal=None, transmission_weight=0.0, emission_color=(1.0, 1.0, 1.0), )"
    R"(emission_strength=0.0, several_bounces=False, at=None)

A Shader: Blender's Principled BSDF, see shlight.nodes.principled.)";

}  // namespace

void bind_bsdf(py::module_& m) {
    py::class_<Bsdf> type(m, "Bsdf", kDoc, without_constructor());
    define_pickling(type, &state_of, &bsdf_from);
    {
        py::options options;
        options.disable_function_signatures();
        type.def_static(
            "principled",
            [](const py::args& positional, const py::kwargs& named) {
                return shader_function("principled")(*positional, **named);
            },
            kPrincipledDoc);
    }
    type.def_static(
            "lambert", &lambert, py::arg("albedo"),
            "Diffuse: f·cos = albedo · cosθ_i / π. albedo: a number or RGB, ≥ 0. Order 2 is exact.\n\n"
            "Of an expression of shlight.nodes, here and below, it is a Shader, which Scene.add_mesh takes too.")
        .def_static(
            "oren_nayar",
            [](const py::object& albedo, const py::object& sigma) {
                return shader_function("oren_nayar")(albedo, sigma);
            },
            py::arg("albedo"), py::arg("sigma"),
            "A Shader: diffuse of roughness sigma, 0 … 1; albedo: a number, RGB or an expression of shlight.nodes.")
        .def_static("ggx", &ggx, py::arg("roughness"), py::arg("f0"), py::kw_only(), py::arg("ior") = py::none(),
                    R"(GGX microfacets with height-correlated Smith masking; alpha = roughness², 0 ≤ roughness ≤ 1.
Below a roughness of 0.003 a perfect mirror: lights reflect in it, but it has no coefficients and evaluates to 0.

f0 (a number or RGB) is the reflectance seen head-on; Fresnel is f0 + (1 - f0) s with Schlick's
s = (1 - cosθ_d)⁵ or, with `ior`, finite and greater than 1, the dielectric Fresnel curve of that index remapped to
0 … 1; s is 0 where the curve of an index above 3.73 dips under its value head-on.
Raises ValueError naming the argument.)")
        .def_static("layer", &layer, py::arg("top"), py::arg("base"),
                    "top + base · (1 - largest channel of top's directional albedo at the view angle).")
        .def("coefficients", &coefficients, py::arg("cos_theta_o"), py::arg("order"),
             R"(Coefficients of f·cos for ω_o = (sinθ_o, 0, cosθ_o): shape (..., order²), float32, or (..., 3, order²)
if the material has colour. They fit the upper hemisphere only: use them with light clipped at the horizon.
Raises ValueError for cos_theta_o outside [0, 1] or an order outside 1 … 64.)")
        .def(
            "residual", &residual, py::arg("cos_theta_o"), py::arg("order"),
            R"(Relative L2 error of that fit over the upper hemisphere, shape (...). For a sum of lobes an upper bound.)")
        .def("evaluate", &evaluate, py::arg("wi"), py::arg("wo"),
             R"(f·cos for directions (..., 3) in the shading frame, which broadcast against each other:
shape (...), or (..., 3) if the material has colour. Zero where either direction lies below the horizon.)")
        .def("__repr__", &repr)
        .def(py::self + py::self)
        .def(
            "__radd__",
            [](const Bsdf& bsdf, const py::int_& start) {
                if (!start.equal(py::int_(0))) {
                    throw py::type_error("a Bsdf can be added to Bsdfs alone");
                }
                return bsdf;
            },
            py::arg("start"), py::is_operator(), "What sum() begins with, 0, adds nothing.")
        .def("__mul__", &scaled, py::arg("factor"), py::is_operator())
        .def("__rmul__", &scaled, py::arg("factor"), py::is_operator())
        // Otherwise numpy would apply `array * bsdf` to each element of the array.
        .attr("__array_ufunc__") = py::none();
}

}  // namespace shlight::python
