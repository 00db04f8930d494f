#include "cad_formats.hpp"
#include "exchange.hpp"
#include "whole_iges.hpp"

#include <batten/core/core.hpp>

#include <IFSelect_ReturnStatus.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESControl_Reader.hxx>
#include <IGESControl_Writer.hxx>
#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESModel.hxx>
#include <IGESData_IGESWriter.hxx>
#include <IGESData_Protocol.hxx>
#include <Interface_Static.hxx>
#include <UnitsMethods.hxx>
#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <sys/mman.h>
#include <unistd.h>

namespace batten::cad {

namespace {

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

void put(const MemoryFile& file, const std::string& content) {
    std::ofstream stream(file.path(), std::ios::binary);
    stream << content;
    if (!stream.flush()) throw SolverError("the file cannot be put into memory");
}

} // namespace

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
        return text_of<IGESData_IGESWriter, IGESData_Protocol>(writer.Model());
    });
}

SplineFile parse_iges(const std::filesystem::path& path, const std::string& content) {
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
        return splines_in(path, reader.OneShape());
    });
}

} // namespace batten::cad
