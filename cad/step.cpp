#include "cad_formats.hpp"
#include "exchange.hpp"

#include <batten/core/core.hpp>

#include <APIHeaderSection_MakeHeader.hxx>
#include <IFSelect_ReturnStatus.hxx>
#include <Interface_Static.hxx>
#include <STEPConstruct_UnitContext.hxx>
#include <STEPControl_Controller.hxx>
#include <STEPControl_Reader.hxx>
#include <STEPControl_Writer.hxx>
#include <StepBasic_Product.hxx>
#include <StepData_Protocol.hxx>
#include <StepData_StepModel.hxx>
#include <StepData_StepWriter.hxx>
#include <StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx.hxx>
#include <StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext.hxx>
#include <StepRepr_GlobalUnitAssignedContext.hxx>
#include <UnitsMethods.hxx>
#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <sstream>

namespace batten::cad {

namespace {

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

bool in_number(char c) {
    return (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '+' || c == 'E';
}

/// A real number with no more digits than tell it from others, and its point.
std::string shortened(std::string_view number) {
    double value = 0;
    const char* end = number.data() + number.size();
    if (std::from_chars(number.data(), end, value).ptr != end) return std::string(number);
    const std::string text = fmt::format("{}", value);
    const std::size_t exponent = std::min(text.find('e'), text.size());
    std::string result(text, 0, exponent);
    if (result.find('.') == std::string::npos) result += '.';
    if (exponent < text.size()) result += 'E' + text.substr(exponent + 1);
    return result;
}

/// The text with its real numbers shortened; what stands in quotes stays.
std::string with_short_numbers(const std::string& text) {
    std::string result;
    result.reserve(text.size());
    bool quoted = false;
    for (std::size_t i = 0; i < text.size();) {
        std::size_t end = i;
        while (!quoted && end < text.size() && in_number(text[end])) ++end;
        const std::string_view number(text.data() + i, end - i);
        if (number.size() > 16 && number.find('.') != std::string_view::npos) {
            result += shortened(number);
        } else {
            end = std::max(end, i + 1);
            if (text[i] == '\'') quoted = !quoted;
            result.append(text, i, end - i);
        }
        i = end;
    }
    return result;
}

/// Millimetres of the unit that the file's first context names; 1 where none does.
double unit_of(const StepData_StepModel& model) {
    using WithUncertainty = StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx;
    using WithoutUncertainty = StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext;
    for (int i = 1; i <= model.NbEntities(); ++i) {
        const auto entity = model.Value(i);
        Handle(StepRepr_GlobalUnitAssignedContext) units;
        if (const auto both = Handle(WithUncertainty)::DownCast(entity))
            units = both->GlobalUnitAssignedContext();
        else if (const auto one = Handle(WithoutUncertainty)::DownCast(entity))
            units = one->GlobalUnitAssignedContext();
        if (units.IsNull()) continue;
        STEPConstruct_UnitContext context;
        if (context.ComputeFactors(units) == 0 && context.LengthFactor() > 0)
            return context.LengthFactor();
    }
    return 1;
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
        return with_short_numbers(text_of<StepData_StepWriter, StepData_Protocol>(writer.Model()));
    });
}

SplineFile parse_step(const std::filesystem::path& path, const std::string& content) {
    const auto lock = alone();
    return translated([&] {
        STEPControl_Reader reader;
        std::istringstream stream(content);
        if (reader.ReadStream("input", stream) != IFSelect_RetDone)
            throw FileError(path.string() + ": not a STEP file that can be read");
        reader.SetSystemLengthUnit(1);
        reader.SetSystemLengthUnit(unit_of(*reader.StepModel())); // coordinates stay as they are
        reader.TransferRoots();
        return splines_in(path, reader.OneShape());
    });
}

} // namespace batten::cad
