// Implements the filter as pipelines see it: its requests to its input, its results block by block, and its errors.
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
#include <optional>
#include <string>

#include "ghost_cells.h"
#include "point_curves.h"
#include "poly_data_normals.h"

vtkStandardNewMacro(vtkChronormalInterpolator);

using Pipeline = vtkStreamingDemandDrivenPipeline;
using chronormal::vtk::NearSteps;
using chronormal::vtk::PointCurves;
using chronormal::vtk::steps_near;

// The data of one execution of the filter.
struct vtkChronormalInterpolator::Request {
  std::vector<double> times;  // times of the steps
  std::size_t from = 0;       // the earlier of the two steps around the time
  double t = 0;               // from 0 at the step `from` to 1 at the next step
  int ghosts = -1;            // number of levels of ghost cells to keep, or -1 if there are no pieces
  std::string place;          // place in composite data, for messages
};

namespace {

using Attributes = std::array<vtkDataSetAttributes*, 2>;

Attributes attributes(vtkDataSet* data) { return {data->GetPointData(), data->GetCellData()}; }

bool has_normals(vtkDataSet* data) {
  return data->GetPointData()->GetNormals() != nullptr || data->GetCellData()->GetNormals() != nullptr;
}

// Returns true if the values of an array are names and not amounts: ids, ghost flags, and texts. Names must not be
// interpolated.
bool is_name(vtkDataSetAttributes* of, vtkAbstractArray* array) {
  return array == of->GetGlobalIds() || array == of->GetPedigreeIds() ||
         array == of->GetAbstractArray(vtkDataSetAttributes::GhostArrayName()) || !array->IsA("vtkDataArray");
}

// Copies the data, with only the arrays that vtkTemporalInterpolator may interpolate. Normals must not be interpolated,
// and texts cannot be.
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

// Copies the arrays of names from the earlier step to the output.
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

// Returns all steps as objects of the class Data, or nothing if a step is of another class.
template <class Data>
std::optional<std::vector<Data*>> all_as(const auto& steps) {
  std::vector<Data*> result;
  for (vtkDataObject* const step : steps) {
    result.push_back(Data::SafeDownCast(step));
    if (result.back() == nullptr || step->IsA(steps.front()->GetClassName()) == 0) return std::nullopt;
  }
  return result;
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
  os << indent << "Path: " << (this->Path == LINEAR ? "linear" : "Catmull-Rom") << '\n';
}

vtkTypeBool vtkChronormalInterpolator::ProcessRequest(vtkInformation* request, vtkInformationVector** inputs,
                                                      vtkInformationVector* outputs) {
  if (!request->Has(Pipeline::REQUEST_UPDATE_EXTENT()))
    return this->Superclass::ProcessRequest(request, inputs, outputs);
  vtkInformation* const in = inputs[0]->GetInformationObject(0);
  vtkInformation* const out = outputs->GetInformationObject(0);
  const int pieces = out->Get(Pipeline::UPDATE_NUMBER_OF_PIECES());
  const int ghosts = out->Get(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS());

  // vtkMultiTimeStepAlgorithm keeps steps whatever piece they belong to. A request for another piece is therefore
  // preceded by a request for information, which makes the algorithm forget the steps.
  const std::array piece = {out->Get(Pipeline::UPDATE_PIECE_NUMBER()), pieces, ghosts};
  if (piece != this->KeptPiece) {
    vtkNew<vtkInformation> forget;
    forget->Set(Pipeline::REQUEST_INFORMATION());
    if (this->Superclass::ProcessRequest(forget, inputs, outputs) == 0) return 0;
    this->KeptPiece = piece;
  }

  // Each step is requested with one more ghost level, since the normals along a seam need the faces on the other side
  // of the seam.
  const vtkTypeBool result = this->Superclass::ProcessRequest(request, inputs, outputs);
  if (pieces > 1) in->Set(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), ghosts + 1);
  return result;
}

int vtkChronormalInterpolator::RequestUpdateExtent(vtkInformation* request, vtkInformationVector** inputs,
                                                   vtkInformationVector* outputs) {
  if (this->Superclass::RequestUpdateExtent(request, inputs, outputs) == 0) return 0;

  // vtkTemporalInterpolator asks for one step at the ends of the range. A mesh that has no area at such a step still
  // has normals, which are limits from inside the segment. Both steps of the segment are therefore needed.
  vtkInformation* const in = inputs[0]->GetInformationObject(0);
  const int count = in->Length(Pipeline::TIME_STEPS());
  this->NumberOfCacheEntries = this->Path == LINEAR ? 2 : 4;
  if (count >= 2 && this->Path == CATMULL_ROM && in->Length(UPDATE_TIME_STEPS()) > 0) {
    // The later requested step is the end of the segment. A time at or before the first step belongs to the first
    // segment.
    double* const times = in->Get(Pipeline::TIME_STEPS());
    const double last = in->Get(UPDATE_TIME_STEPS())[in->Length(UPDATE_TIME_STEPS()) - 1];
    const auto end = static_cast<std::size_t>(std::lower_bound(times + 1, times + count - 1, last) - times);
    const NearSteps near = steps_near(end - 1, static_cast<std::size_t>(count));
    in->Set(UPDATE_TIME_STEPS(), times + near.first, static_cast<int>(near.count));
    return 1;
  }
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
    vtkErrorMacro("There are no data to interpolate. Connect an input with time steps.");
    return 0;
  }
  Request request;
  Steps<vtkDataObject> steps;
  for (vtkDataObject* const step : inputs) {
    steps.push_back(step);
    request.times.push_back(time_of(step));
  }
  const std::vector<double>& times = request.times;
  const double time = out->Has(Pipeline::UPDATE_TIME_STEP()) ? out->Get(Pipeline::UPDATE_TIME_STEP()) : times.front();
  if (steps.size() == 1) {  // a single step, so the mesh does not move
    steps.push_back(steps.front());
    request.times.push_back(times.front());
  }
  while (request.from + 2 < times.size() && time > times[request.from + 1]) ++request.from;
  const double start = times[request.from], end = times[request.from + 1];
  if (end > start) request.t = std::clamp((time - start) / (end - start), 0.0, 1.0);
  if (out->Get(Pipeline::UPDATE_NUMBER_OF_PIECES()) > 1)
    request.ghosts = out->Get(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS());

  const vtkSmartPointer<vtkDataObject> result = this->Interpolate(steps, request);
  output->Initialize();
  if (result == nullptr) return 0;
  output->ShallowCopy(result);
  output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), time);

  vtkNew<vtkDoubleArray> original;
  original->SetName("OriginalTimeSteps");
  for (vtkDataObject* const step : inputs) original->InsertNextValue(time_of(step));
  output->GetFieldData()->AddArray(original);
  return 1;
}

vtkSmartPointer<vtkDataObject> vtkChronormalInterpolator::Interpolate(const Steps<vtkDataObject>& steps,
                                                                      const Request& request) {
  if (const auto blocks = all_as<vtkCompositeDataSet>(steps)) return this->InterpolateBlocks(*blocks, request);
  if (const auto data = all_as<vtkDataSet>(steps)) return this->InterpolateMesh(*data, request);
  vtkErrorMacro(<< request.place << "A " << steps[request.from]->GetClassName() << " and a "
                << steps[request.from + 1]->GetClassName()
                << " cannot be interpolated. Give all steps the same class of vtkDataSet or of vtkCompositeDataSet.");
  return nullptr;
}

vtkSmartPointer<vtkDataObject> vtkChronormalInterpolator::InterpolateBlocks(const Steps<vtkCompositeDataSet>& steps,
                                                                            const Request& request) {
  std::vector<vtkSmartPointer<vtkCompositeDataIterator>> blocks;
  for (vtkCompositeDataSet* const step : steps) {
    blocks.push_back(vtkSmartPointer<vtkCompositeDataIterator>::Take(step->NewIterator()));
    blocks.back()->SkipEmptyNodesOff();
    blocks.back()->InitTraversal();
  }
  const auto result = vtkSmartPointer<vtkCompositeDataSet>::Take(steps[request.from]->NewInstance());
  result->CopyStructure(steps[request.from]);
  const auto is_done = [](vtkCompositeDataIterator* block) { return block->IsDoneWithTraversal() != 0; };
  while (std::none_of(blocks.begin(), blocks.end(), is_done)) {
    const unsigned int index = blocks.front()->GetCurrentFlatIndex();
    Request of_block = request;
    of_block.place = "block " + std::to_string(index) + ": ";
    Steps<vtkDataObject> data;
    bool is_same = true;
    for (vtkCompositeDataIterator* const block : blocks) {
      data.push_back(block->GetCurrentDataObject());
      is_same = is_same && block->GetCurrentFlatIndex() == index && (data.back() == nullptr) == (data[0] == nullptr);
    }
    if (!is_same) {
      vtkErrorMacro(<< of_block.place << "This block is in only one of the two steps. Give all steps the same blocks.");
      return nullptr;
    }
    if (data[0] != nullptr) {
      const vtkSmartPointer<vtkDataObject> block = this->Interpolate(data, of_block);
      if (block == nullptr) return nullptr;
      result->SetDataSet(blocks[request.from], block);
    }
    for (vtkCompositeDataIterator* const block : blocks) block->GoToNextItem();
  }
  if (!std::all_of(blocks.begin(), blocks.end(), is_done)) {
    vtkErrorMacro("The two steps have different numbers of blocks. Give all steps the same blocks.");
    return nullptr;
  }
  return result;
}

vtkSmartPointer<vtkDataSet> vtkChronormalInterpolator::InterpolateMesh(const Steps<vtkDataSet>& steps,
                                                                       const Request& request) {
  vtkDataSet* const from = steps[request.from];
  vtkDataSet* const to = steps[request.from + 1];
  auto* const mesh = vtkPolyData::SafeDownCast(from);
  if (mesh == nullptr && std::any_of(steps.begin(), steps.end(), has_normals)) {
    vtkErrorMacro(<< request.place << "The normals of a " << from->GetClassName()
                  << " are those of its surface. Extract the surface first, with vtkDataSetSurfaceFilter.");
    return nullptr;
  }
  for (std::size_t k = 0; k < steps.size(); ++k) {
    if (k == request.from) continue;
    chronormal::Status motion = chronormal::Success{};
    if (mesh != nullptr)
      motion = chronormal::vtk::check_motion(mesh, vtkPolyData::SafeDownCast(steps[k]));
    else if (this->Path == CATMULL_ROM && steps[k]->GetNumberOfPoints() != from->GetNumberOfPoints())
      motion = chronormal::invalid_input("", "the two steps have different numbers of points");
    if (motion) continue;
    vtkErrorMacro(<< request.place << motion.error().text() << ", so there is no motion between the steps at times "
                  << request.times[std::min(k, request.from)] << " and " << request.times[std::max(k, request.from)]
                  << ". Give all steps the same points and cells, with finite coordinates.");
    return nullptr;
  }

  const auto output =
      vtkSmartPointer<vtkDataSet>::Take(this->Superclass::InterpolateDataSet(amounts(from), amounts(to), request.t));
  keep_names(from, output);
  const auto curved = this->Path == CATMULL_ROM ? all_as<vtkPointSet>(steps) : std::nullopt;
  PointCurves curves;
  if (curved) {
    curves = chronormal::vtk::curves_through(*curved, request.times, request.from);
    vtkPoints* const points = curved->front()->GetPoints();
    if (points != nullptr)
      vtkPointSet::SafeDownCast(output)->SetPoints(
          chronormal::vtk::points_at(curves, request.t, points->GetDataType()));
  }
  if (mesh == nullptr) return output;

  const bool points = this->ComputePointNormals || mesh->GetPointData()->GetNormals() != nullptr;
  const bool cells = this->ComputeCellNormals || mesh->GetCellData()->GetNormals() != nullptr;
  const auto normals =
      curved ? chronormal::vtk::normals_on_curves(mesh, curves, request.t, points, cells)
             : chronormal::vtk::normals_between(mesh, vtkPolyData::SafeDownCast(to), request.t, points, cells);
  if (points) set_normals(output->GetPointData(), mesh->GetPointData(), normals.of_points);
  if (cells) set_normals(output->GetCellData(), mesh->GetCellData(), normals.of_cells);
  if (request.ghosts >= 0) chronormal::vtk::keep_ghost_levels(vtkPolyData::SafeDownCast(output), request.ghosts);
  return output;
}
