#include "exchange.hpp"

#include <batten/core/core.hpp>
#include <batten/core/names.hpp>

#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_PrinterOStream.hxx>
#include <cmath>
#include <fmt/format.h>

namespace batten::cad {

namespace {

void check_finite(const std::vector<Spline>& splines, const std::filesystem::path& path) {
    for (const Spline& spline : splines)
        for (double x : spline.control_points().values())
            if (!std::isfinite(x))
                throw FileError(path.string() + ": a control point is not a finite number");
}

} // namespace

std::unique_lock<std::mutex> alone() {
    static std::mutex mutex;
    std::unique_lock lock(mutex);
    Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_PrinterOStream));
    return lock;
}

const char* unit_name(const std::string& unit) {
    constexpr std::string_view ours[] = {"mm", "cm", "m", "in"};
    constexpr const char* theirs[] = {"MM", "CM", "M", "INCH"};
    for (std::size_t k = 0; k < std::size(ours); ++k)
        if (unit == ours[k]) return theirs[k];
    throw InvalidInput(unknown_name("unit", unit, ours));
}

std::string plain(const std::string& text) {
    std::string result;
    for (char c : text) {
        const auto code = static_cast<unsigned char>(c);
        if ((code & 0xC0U) == 0x80U) continue; // the rest of a character of several bytes
        result += code >= 0x20 && code < 0x7F && c != '\'' ? c : '?';
    }
    return result.empty() ? "spline" : result;
}

Handle(TCollection_HAsciiString) words(const std::string& text) {
    return new TCollection_HAsciiString(text.c_str());
}

void write_all_digits(Interface_FloatWriter& writer) {
    writer.SetFormat("%#.17G"); // its own way of leaving zeros out keeps fourteen digits
    writer.SetZeroSuppress(false);
}

void give_up(const Standard_Failure& failure) {
    const std::string_view words = failure.GetMessageString();
    throw SolverError(plain(
        fmt::format("{}{}{}", failure.DynamicType()->Name(), words.empty() ? "" : ": ", words)));
}

SplineFile splines_in(const std::filesystem::path& path, const TopoDS_Shape& shape) {
    Found found;
    try {
        found = found_in(shape);
    } catch (const RationalSpline& error) {
        throw InvalidInput(fmt::format("{}: {}", path.string(), error.what()));
    } catch (const InvalidInput& error) {
        throw FileError(fmt::format("{}: {}", path.string(), error.what()));
    }
    if (found.splines.empty())
        throw FileError(path.string() + ": the file holds no B-spline curve or surface");
    check_finite(found.splines, path);
    SplineFile result{std::move(found.splines), {}};
    if (found.trims_dropped > 0)
        result.notes.push_back(fmt::format("{} of its faces {} trimmed along curves: read whole, "
                                           "without the trims",
                                           found.trims_dropped,
                                           found.trims_dropped == 1 ? "is" : "are"));
    if (found.others > 0)
        result.notes.push_back(fmt::format("{} of its faces and edges {} no B-spline: left out",
                                           found.others, found.others == 1 ? "is" : "are"));
    return result;
}

} // namespace batten::cad
