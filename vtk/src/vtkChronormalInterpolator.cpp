// The filter as pipelines see it: what it asks of its input, what it makes of the data block by block, and its errors.
#include "vtkChronormalInterpolator.h"

#include <vtkCellData.h>
#include <vtkCompositeDataIterator.h>
#include <vtkCompositeDataSet.h>
#include <vtkDataSetAttributes.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkInformation.h>
#include <vtkInformationDoubleVectorKey.h>
#include <vtkInformationVector.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkStreamingDemandDrivenPipeline.h>

#include <algorithm>
#include <array>
#include <string>

#include "ghost_cells.h"
#include "poly_data_normals.h"

vtkStandardNewMacro(vtkChronormalInterpolator);

using Pipeline = vtkStreamingDemandDrivenPipeline;

// The request of one execution.
struct vtkChronormalInterpolator::Request {
  double start = 0;   // the time of the earlier step
  double end = 0;     // that of the later one
  double t = 0;       // from the earlier step, 0, to the later one, 1
  int ghosts = -1;    // how many levels of ghost cells to keep, or -1 where a whole is asked for
  std::string place;  // where the data are in composite data, for messages
};

namespace {

using Attributes = std::array<vtkDataSetAttributes*, 2>;

Attributes attributes(vtkDataSet* data) { return {data->GetPointData(), data->GetCellData()}; }

bool has_normals(vtkDataSet* data) {
  return data->GetPointData()->GetNormals() != nullptr || data->GetCellData()->GetNormals() != nullptr;
}

// Whether an array has names and not amounts: ids, ghost flags, and texts. It must not be mixed as if it had amounts.
bool is_name(vtkDataSetAttributes* of, vtkAbstractArray* array) {
  return array == of->GetGlobalIds() || array == of->GetPedigreeIds() ||
         array == of->GetAbstractArray(vtkDataSetAttributes::GhostArrayName()) || !array->IsA("vtkDataArray");
}

// A copy of the data with what vtkTemporalInterpolator may mix: all arrays except normals, and texts, which it cannot
// mix.
vtkSmartPointer<vtkDataSet> amounts(vtkDataSet* data) {
  const auto copy = vtkSmartPointer<vtkDataSet>::Take(data->NewInstance());
  copy->ShallowCopy(data);
  for (vtkDataSetAttributes* const of : attributes(copy)) {
    of->SetNormals(nullptr);
    for (int i = of->GetNumberOfArrays() - 1; i >= 0; --i)
      if (!of->GetAbstractArray(i)->IsA("vtkDataArray")) of->RemoveArray(i);
  }
  return copy;
}

// Takes arrays of names from the earlier step.
void keep_names(vtkDataSet* before, vtkDataSet* output) {
  const Attributes from = attributes(before), to = attributes(output);
  for (std::size_t k = 0; k < from.size(); ++k) {
    for (int i = 0; i < from[k]->GetNumberOfArrays(); ++i) {
      vtkAbstractArray* const array = from[k]->GetAbstractArray(i);
      if (!is_name(from[k], array) || array->GetName() == nullptr) continue;
      to[k]->AddArray(array);
      if (array == from[k]->GetPedigreeIds()) to[k]->SetPedigreeIds(array);
    }
  }
}

void set_normals(vtkDataSetAttributes* output, vtkDataSetAttributes* before, vtkDataArray* normals) {
  vtkDataArray* const stored = before->GetNormals();
  normals->SetName(stored != nullptr && stored->GetName() != nullptr ? stored->GetName() : "Normals");
  output->SetNormals(normals);
}

double time_of(vtkDataObject* step) {
  return step->GetInformation()->Has(vtkDataObject::DATA_TIME_STEP())
             ? step->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP())
             : 0;
}

}  // namespace

void vtkChronormalInterpolator::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "ComputePointNormals: " << (this->ComputePointNormals ? "on" : "off") << '\n';
  os << indent << "ComputeCellNormals: " << (this->ComputeCellNormals ? "on" : "off") << '\n';
}

vtkTypeBool vtkChronormalInterpolator::ProcessRequest(vtkInformation* request, vtkInformationVector** inputs,
                                                      vtkInformationVector* outputs) {
  if (!request->Has(Pipeline::REQUEST_UPDATE_EXTENT()))
    return this->Superclass::ProcessRequest(request, inputs, outputs);
  vtkInformation* const in = inputs[0]->GetInformationObject(0);
  vtkInformation* const out = outputs->GetInformationObject(0);
  const int pieces = out->Get(Pipeline::UPDATE_NUMBER_OF_PIECES());
  const int ghosts = out->Get(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS());

  // The steps that vtkMultiTimeStepAlgorithm keeps belong to one piece. It forgets them when it is asked for
  // information.
  const std::array piece = {out->Get(Pipeline::UPDATE_PIECE_NUMBER()), pieces, ghosts};
  if (piece != this->KeptPiece) {
    vtkNew<vtkInformation> forget;
    forget->Set(Pipeline::REQUEST_INFORMATION());
    if (this->Superclass::ProcessRequest(forget, inputs, outputs) == 0) return 0;
    this->KeptPiece = piece;
  }

  // Each step needs the faces on the other side of a seam.
  const vtkTypeBool result = this->Superclass::ProcessRequest(request, inputs, outputs);
  if (pieces > 1) in->Set(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), ghosts + 1);
  return result;
}

int vtkChronormalInterpolator::RequestUpdateExtent(vtkInformation* request, vtkInformationVector** inputs,
                                                   vtkInformationVector* outputs) {
  if (this->Superclass::RequestUpdateExtent(request, inputs, outputs) == 0) return 0;

  // At the ends of the range vtkTemporalInterpolator asks for one step. A mesh that has no area there still has
  // normals, their limits from within the segment, so both steps are needed.
  vtkInformation* const in = inputs[0]->GetInformationObject(0);
  const int count = in->Length(Pipeline::TIME_STEPS());
  if (count >= 2 && in->Length(UPDATE_TIME_STEPS()) == 1) {
    const double* const times = in->Get(Pipeline::TIME_STEPS());
    const bool at_start = in->Get(UPDATE_TIME_STEPS())[0] == times[0];
    std::array<double, 2> ends = {times[at_start ? 0 : count - 2], times[at_start ? 1 : count - 1]};
    in->Set(UPDATE_TIME_STEPS(), ends.data(), 2);
  }
  return 1;
}

int vtkChronormalInterpolator::Execute(vtkInformation*, const std::vector<vtkSmartPointer<vtkDataObject>>& inputs,
                                       vtkInformationVector* outputs) {
  vtkInformation* const out = outputs->GetInformationObject(0);
  vtkDataObject* const output = vtkDataObject::GetData(out);
  if (inputs.empty() || inputs.front() == nullptr || inputs.back() == nullptr) {
    vtkErrorMacro("There is no data to interpolate.");
    return 0;
  }
  vtkDataObject* const from = inputs.front();
  vtkDataObject* const to = inputs.back();
  Request request;
  request.start = time_of(from);
  request.end = time_of(to);
  const double time = out->Has(Pipeline::UPDATE_TIME_STEP()) ? out->Get(Pipeline::UPDATE_TIME_STEP()) : request.start;
  if (request.end > request.start)
    request.t = std::clamp((time - request.start) / (request.end - request.start), 0.0, 1.0);
  if (out->Get(Pipeline::UPDATE_NUMBER_OF_PIECES()) > 1)
    request.ghosts = out->Get(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS());

  const vtkSmartPointer<vtkDataObject> result = this->Interpolate(from, to, request);
  output->Initialize();
  if (result == nullptr) return 0;
  output->ShallowCopy(result);
  output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), time);

  vtkNew<vtkDoubleArray> steps;
  steps->SetName("OriginalTimeSteps");
  for (vtkDataObject* const step : inputs) steps->InsertNextValue(time_of(step));
  output->GetFieldData()->AddArray(steps);
  return 1;
}

vtkSmartPointer<vtkDataObject> vtkChronormalInterpolator::Interpolate(vtkDataObject* from, vtkDataObject* to,
                                                                      const Request& request) {
  if (auto* const blocks = vtkCompositeDataSet::SafeDownCast(from)) {
    if (auto* const later = vtkCompositeDataSet::SafeDownCast(to))
      return this->InterpolateBlocks(blocks, later, request);
  } else if (auto* const data = vtkDataSet::SafeDownCast(from)) {
    if (auto* const later = vtkDataSet::SafeDownCast(to); later != nullptr && later->IsA(data->GetClassName()))
      return this->InterpolateMesh(data, later, request);
  }
  vtkErrorMacro(<< request.place << "A " << from->GetClassName() << " and a " << to->GetClassName()
                << " cannot be interpolated.");
  return nullptr;
}

vtkSmartPointer<vtkDataObject> vtkChronormalInterpolator::InterpolateBlocks(vtkCompositeDataSet* from,
                                                                            vtkCompositeDataSet* to,
                                                                            const Request& request) {
  const auto blocks = [](vtkCompositeDataSet* data) {
    const auto iterator = vtkSmartPointer<vtkCompositeDataIterator>::Take(data->NewIterator());
    iterator->SkipEmptyNodesOff();
    iterator->InitTraversal();
    return iterator;
  };
  const auto result = vtkSmartPointer<vtkCompositeDataSet>::Take(from->NewInstance());
  result->CopyStructure(from);
  const auto earlier = blocks(from), later = blocks(to);
  for (; !earlier->IsDoneWithTraversal() && !later->IsDoneWithTraversal();
       earlier->GoToNextItem(), later->GoToNextItem()) {
    Request of_block = request;
    of_block.place = "block " + std::to_string(earlier->GetCurrentFlatIndex()) + ": ";
    vtkDataObject* const before = earlier->GetCurrentDataObject();
    vtkDataObject* const after = later->GetCurrentDataObject();
    if (before == nullptr && after == nullptr) continue;
    if (before == nullptr || after == nullptr || earlier->GetCurrentFlatIndex() != later->GetCurrentFlatIndex()) {
      vtkErrorMacro(<< of_block.place << "It is in one of the two steps only.");
      return nullptr;
    }
    const vtkSmartPointer<vtkDataObject> block = this->Interpolate(before, after, of_block);
    if (block == nullptr) return nullptr;
    result->SetDataSet(earlier, block);
  }
  if (!earlier->IsDoneWithTraversal() || !later->IsDoneWithTraversal()) {
    vtkErrorMacro("The two steps have other numbers of blocks.");
    return nullptr;
  }
  return result;
}

vtkSmartPointer<vtkDataSet> vtkChronormalInterpolator::InterpolateMesh(vtkDataSet* from, vtkDataSet* to,
                                                                       const Request& request) {
  auto* const mesh = vtkPolyData::SafeDownCast(from);
  auto* const later = vtkPolyData::SafeDownCast(to);
  if (mesh == nullptr && (has_normals(from) || has_normals(to))) {
    vtkErrorMacro(<< request.place << "The normals of a " << from->GetClassName()
                  << " are those of its surface: extract it first, by vtkDataSetSurfaceFilter.");
    return nullptr;
  }
  if (mesh != nullptr) {
    if (const chronormal::Status motion = chronormal::vtk::check_motion(mesh, later); !motion) {
      vtkErrorMacro(<< request.place << motion.error().text() << ", so there is no motion between the steps at times "
                    << request.start << " and " << request.end << '.');
      return nullptr;
    }
  }

  const auto output =
      vtkSmartPointer<vtkDataSet>::Take(this->Superclass::InterpolateDataSet(amounts(from), amounts(to), request.t));
  keep_names(from, output);
  if (mesh == nullptr) return output;

  const bool points = this->ComputePointNormals || mesh->GetPointData()->GetNormals() != nullptr;
  const bool cells = this->ComputeCellNormals || mesh->GetCellData()->GetNormals() != nullptr;
  const auto normals = chronormal::vtk::normals_between(mesh, later, request.t, points, cells);
  if (points) set_normals(output->GetPointData(), mesh->GetPointData(), normals.of_points);
  if (cells) set_normals(output->GetCellData(), mesh->GetCellData(), normals.of_cells);
  if (request.ghosts >= 0) chronormal::vtk::keep_ghost_levels(vtkPolyData::SafeDownCast(output), request.ghosts);
  return output;
}
