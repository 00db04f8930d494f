#include "cad_formats.hpp"
#include "geometry.hpp"

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
#include <cstdlib>
#include <mutex>
#include <sstream>
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

/// A file in the folder for temporary files that is gone with the object.
class TemporaryFile {
  public:
    explicit TemporaryFile(const std::string& suffix) {
        std::string name =
            (std::filesystem::temp_directory_path() / ("batten-XXXXXX" + suffix)).string();
        const int file = mkstemps(name.data(), static_cast<int>(suffix.size()));
        if (file < 0) throw FileError(name + ": no temporary file can be made");
        close(file);
        path_ = name;
    }
    ~TemporaryFile() {
        std::error_code ignored;
        std::filesystem::remove(path_, ignored);
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    const std::string& path() const { return path_; }

  private:
    std::string path_;
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
        throw SolverError(fmt::format("Open CASCADE: {}", failure.GetMessageString()));
    }
}

template <class Writer>
std::string written(Writer& writer, const std::string& suffix) {
    const TemporaryFile file(suffix);
    writer(file.path());
    return read_file(file.path());
}

std::vector<Spline> found_in(const std::filesystem::path& path, const TopoDS_Shape& shape) {
    std::vector<Spline> splines;
    try {
        splines = splines_of(shape);
    } catch (const InvalidInput& error) {
        throw InvalidInput(fmt::format("{}: {}", path.string(), error.what()));
    }
    if (splines.empty())
        throw FileError(path.string() + ": the file holds no B-spline curve or surface");
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
            if (writer.Write(path.c_str()) != IFSelect_RetDone)
                throw FileError(path + ": cannot be written");
        };
        return written(write, ".step");
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
        const auto write = [&](const std::string& path) {
            if (!writer.Write(path.c_str())) throw FileError(path + ": cannot be written");
        };
        return written(write, ".igs");
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
    const auto lock = alone();
    return translated([&] {
        const TemporaryFile file(".igs");
        write_file(file.path(), content);
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

const batten::cad::Module* batten_cad_module() {
    using namespace batten::cad;
    static const Module module{step_text, iges_text, parse_step, parse_iges};
    return &module;
}
