#include <batten/fit/written_shape.hpp>

#include <batten/shape/limits.hpp>

namespace batten {

void keep_as_written(Fitted& fitted) {
    FitReport& report = fitted.report;
    if (report.allowed_inflections < 0) return;
    const Closure closure = fitted.spline.axis(0).closure();
    const PointSet control = fitted.spline.free_control_points();
    PointSet exact = with_exact_turns(control, closure, report.allowed_inflections);
    report.inflections = inflection_count(exact, closure, exactly);
    if (exact.values() == control.values()) return;
    fitted.spline = Spline::from_free(fitted.spline.axes(), std::move(exact));
    fitted.deviations.clear(); // they are measured again
}

} // namespace batten
