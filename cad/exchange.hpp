#pragma once

#include "geometry.hpp"

#include <batten/io/spline_file.hpp>

#include <Interface_FloatWriter.hxx>
#include <Standard_Failure.hxx>
#include <TCollection_HAsciiString.hxx>
#include <filesystem>
#include <mutex>
#include <sstream>
#include <string>

namespace batten::cad {

/// The date in files of which none was asked for.
inline constexpr const char* fixed_date = "2000-01-01T00:00:00";

/// Open CASCADE keeps its settings in one place for all: one exchange at a time, and none of its
/// printing.
std::unique_lock<std::mutex> alone();

/// Open CASCADE's name of the unit; throws InvalidInput for one that is not known.
const char* unit_name(const std::string& unit);

/// Text that both formats can hold in a string: other characters as '?'.
std::string plain(const std::string& text);

Handle(TCollection_HAsciiString) words(const std::string& text);

/// Makes numbers be written with every digit they have.
void write_all_digits(Interface_FloatWriter& writer);

/// The text of a file of either format.
template <class Writer, class Protocol, class Model>
std::string text_of(const Handle(Model) & model) {
    Writer writer(model);
    write_all_digits(writer.FloatWriter());
    writer.SendModel(Handle(Protocol)::DownCast(model->Protocol()));
    std::ostringstream stream;
    if (!writer.Print(stream)) throw SolverError("the text cannot be made");
    return stream.str();
}

/// Throws SolverError with Open CASCADE's words.
[[noreturn]] void give_up(const Standard_Failure& failure);

/// Runs `work`; Open CASCADE's failures become SolverError.
template <class Work>
auto translated(Work work) {
    try {
        return work();
    } catch (const Standard_Failure& failure) {
        give_up(failure);
    }
}

/// The splines of a shape that was read from a file, and what is said of them; throws FileError and
/// InvalidInput with its path.
SplineFile splines_in(const std::filesystem::path& path, const TopoDS_Shape& shape);

} // namespace batten::cad
