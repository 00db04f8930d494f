#include "cad_formats.hpp"
#include "geometry.hpp"
#include "whole_iges.hpp"

#include <batten/core/core.hpp>
#include <batten/core/names.hpp>
#include <batten/io/output_file.hpp>

#include <APIHeaderSection_MakeHeader.hxx>
#include <IFSelect_ReturnStatus.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESControl_Reader.hxx>
#include <IGESControl_Writer.hxx>
#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_PrinterOStream.hxx>
#include <STEPControl_Controller.hxx>
#include <STEPControl_Reader.hxx>
#include <STEPControl_Writer.hxx>
#include <Standard_Failure.hxx>
#include <StepBasic_Product.hxx>
#include <StepData_StepModel.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TCollection_HAsciiString.hxx>
#include <UnitsMethods.hxx>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <mutex>
#include <sstream>
#include <sys/mman.h>
#include <unistd.h>

namespace batten::cad {

namespace {

constexpr const char* fixed_date = "2000-01-01T00:00:00";

/// Open CASCADE keeps its settings in one place for all: one exchange at a time, and none of its
/// printing.
std::unique_lock<std::mutex> alone() {
    static std::mutex mutex;
    std::unique_lock lock(mutex);
    Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_PrinterOStream));
    return lock;
}

/// A file that is only in memory, under a name that Open CASCADE can open: nothing of it stays,
/// however this process ends.
class MemoryFile {
  public:
    MemoryFile() : file_(memfd_create("batten-cad", MFD_CLOEXEC)) {
        if (file_ < 0) throw SolverError("no file can be made in memory");
    }
    ~MemoryFile() { close(file_); }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;
    std::string path() const { return fmt::format("/proc/self/fd/{}", file_); }

  private:
    int file_;
};

/// Open CASCADE's name of the unit.
const char* unit_name(const std::string& unit) {
    constexpr std::string_view ours[] = {"mm", "cm", "m", "in"};
    constexpr const char* theirs[] = {"MM", "CM", "M", "INCH"};
    for (std::size_t k = 0; k < std::size(ours); ++k)
        if (unit == ours[k]) return theirs[k];
    throw InvalidInput(unknown_name("unit", unit, ours));
}

/// Text that both formats can hold in a string: other characters as '?'.
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

/// Names the products by title, and by number where there are several: Open CASCADE counts on from
/// file to file.
void name_products(const StepData_StepModel& model, const std::string& title) {
    int count = 0;
    for (int i = 1; i <= model.NbEntities(); ++i) {
        const auto product = Handle(StepBasic_Product)::DownCast(model.Value(i));
        if (product.IsNull()) continue;
        ++count;
        const auto name = words(count == 1 ? title : fmt::format("{} {}", title, count));
        product->SetName(name);
        product->SetId(name);
    }
}

/// Runs `work`; Open CASCADE's failures become SolverError.
template <class Work>
auto translated(Work work) {
    try {
        return work();
    } catch (const Standard_Failure& failure) {
        const std::string_view words = failure.GetMessageString();
        throw SolverError(plain(fmt::format("{}{}{}", failure.DynamicType()->Name(),
                                            words.empty() ? "" : ": ", words)));
    }
}

template <class Writer>
std::string written(Writer& writer) {
    const MemoryFile file;
    if (!writer(file.path())) throw SolverError("the text cannot be made");
    return read_file(file.path());
}

void put(const MemoryFile& file, const std::string& content) {
    std::ofstream stream(file.path(), std::ios::binary);
    stream << content;
    if (!stream.flush()) throw SolverError("the file cannot be put into memory");
}

void check_finite(const std::vector<Spline>& splines, const std::filesystem::path& path) {
    for (const Spline& spline : splines)
        for (double x : spline.control_points().values())
            if (!std::isfinite(x))
                throw FileError(path.string() + ": a control point is not a finite number");
}

std::vector<Spline> found_in(const std::filesystem::path& path, const TopoDS_Shape& shape) {
    std::vector<Spline> splines;
    try {
        splines = splines_of(shape);
    } catch (const RationalSpline& error) {
        throw InvalidInput(fmt::format("{}: {}", path.string(), error.what()));
    } catch (const InvalidInput& error) {
        throw FileError(fmt::format("{}: {}", path.string(), error.what()));
    }
    if (splines.empty())
        throw FileError(path.string() + ": the file holds no B-spline curve or surface");
    check_finite(splines, path);
    return splines;
}

} // namespace

std::string step_text(const Scene& scene) {
    const auto lock = alone();
    return translated([&] {
        STEPControl_Controller::Init();
        STEPControl_Writer writer; // first: it brings the settings into being
        const char* unit = unit_name(scene.unit);
        Interface_Static::SetCVal("xstep.cascade.unit", unit); // coordinates stay as they are
        Interface_Static::SetCVal("write.step.unit", unit);
        Interface_Static::SetCVal("write.step.schema", "AP214IS");
        const double millimetres = UnitsMethods::GetLengthFactorValue(
            Interface_Static::IVal("write.step.unit")); // of one unit
        writer.Model(true)->SetLocalLengthUnit(millimetres);
        writer.Model()->SetWriteLengthUnit(millimetres);
        Interface_Static::SetCVal("write.step.product.name", plain(scene.title).c_str());
        for (const Spline* spline : scene.splines())
            if (writer.Transfer(shape_of(*spline), STEPControl_AsIs) != IFSelect_RetDone)
                throw SolverError("Open CASCADE cannot write this spline as STEP");
        name_products(*writer.Model(), plain(scene.title));
        APIHeaderSection_MakeHeader header(writer.Model());
        header.SetName(words(plain(scene.title)));
        header.SetTimeStamp(words(scene.date.empty() ? fixed_date : plain(scene.date)));
        header.SetOriginatingSystem(words("batten"));
        const auto write = [&](const std::string& path) {
            return writer.Write(path.c_str()) == IFSelect_RetDone;
        };
        return written(write);
    });
}

std::string iges_text(const Scene& scene) {
    const auto lock = alone();
    return translated([&] {
        IGESControl_Controller::Init();
        const char* unit = unit_name(scene.unit);
        Interface_Static::SetCVal("xstep.cascade.unit", unit);
        IGESControl_Writer writer(unit, 0);
        IGESData_GlobalSection start = writer.Model()->GlobalSection();
        start.SetCascadeUnit(UnitsMethods::GetLengthFactorValue(start.UnitFlag()));
        writer.Model()->SetGlobalSection(start);
        for (const Spline* spline : scene.splines())
            if (!writer.AddShape(shape_of(*spline)))
                throw SolverError("Open CASCADE cannot write this spline as IGES");
        writer.ComputeModel();
        IGESData_GlobalSection global = writer.Model()->GlobalSection();
        // 2000-01-01T00:00:00 becomes 20000101.000000
        std::string date = scene.date.empty() ? fixed_date : plain(scene.date);
        std::erase_if(date, [](char c) { return c == '-' || c == ':'; });
        std::ranges::replace(date, 'T', '.');
        global.SetDate(words(date));
        global.SetLastChangeDate(words(date));
        global.SetSendName(words(plain(scene.title)));
        global.SetReceiveName(words(plain(scene.title)));
        global.SetFileName(words(plain(scene.title)));
        global.SetAuthorName(words("batten"));
        global.SetCompanyName(words("batten"));
        global.SetSystemId(words("batten"));
        writer.Model()->SetGlobalSection(global);
        const auto write = [&](const std::string& path) { return writer.Write(path.c_str()); };
        return written(write);
    });
}

std::vector<Spline> parse_step(const std::filesystem::path& path, const std::string& content) {
    const auto lock = alone();
    return translated([&] {
        STEPControl_Reader reader;
        std::istringstream stream(content);
        if (reader.ReadStream("input", stream) != IFSelect_RetDone)
            throw FileError(path.string() + ": not a STEP file that can be read");
        TColStd_SequenceOfAsciiString lengths;
        TColStd_SequenceOfAsciiString angles;
        TColStd_SequenceOfAsciiString solid_angles;
        reader.FileUnits(lengths, angles, solid_angles);
        std::string unit = lengths.IsEmpty() ? "" : lengths.First().ToCString();
        std::ranges::transform(unit, unit.begin(), [](unsigned char c) { return std::tolower(c); });
        Interface_Static::SetCVal("xstep.cascade.unit", unit.starts_with("metre")   ? "M"
                                                        : unit.starts_with("centi") ? "CM"
                                                        : unit.starts_with("inch")  ? "INCH"
                                                                                    : "MM");
        reader.TransferRoots();
        return found_in(path, reader.OneShape());
    });
}

std::vector<Spline> parse_iges(const std::filesystem::path& path, const std::string& content) {
    check_whole_iges(path, content);
    const auto lock = alone();
    return translated([&] {
        const MemoryFile file;
        put(file, content);
        IGESControl_Reader reader;
        Interface_Static::SetIVal("read.iges.bspline.continuity", 0); // knots stay as they are
        if (reader.ReadFile(file.path().c_str()) != IFSelect_RetDone)
            throw FileError(path.string() + ": not an IGES file that can be read");
        // the coordinates as they stand: the system's unit is made the file's
        const Handle(IGESData_IGESModel) model = reader.IGESModel();
        IGESData_GlobalSection global = model->GlobalSection();
        const double millimetres = UnitsMethods::GetLengthFactorValue(global.UnitFlag());
        global.SetCascadeUnit(millimetres);
        model->SetGlobalSection(global);
        UnitsMethods::SetCasCadeLengthUnit(millimetres);
        reader.TransferRoots();
        return found_in(path, reader.OneShape());
    });
}

} // namespace batten::cad
