/// Replaces vtkTemporalInterpolator in a pipeline by a filter with true normals.
///
/// Positions and all other arrays are interpolated as vtkTemporalInterpolator does. However, the normals of every
/// vtkPolyData, alone or in blocks of composite data, are the true normals of the mesh at the requested time, and not
/// mixtures of stored normals. See docs/simulation.md.
///
/// Normals    Point normals are sums over the faces around a point, weighted by area; cell normals are the normals of
///            the cells. Both are of length 1, or (0, 0, 0) where there is no face. Normals of the input are replaced;
///            ComputePointNormals and ComputeCellNormals say whether normals are also computed for an input
///            without normals. Normals are in double if the points are.
/// Path       Points move on straight lines between two steps, as in vtkTemporalInterpolator, or on curves through four
///            steps: SetPathToCatmullRom(). On curves, positions and normals are those of the curve; all other arrays
///            are interpolated linearly.
/// Time       Any time is valid: outside the range of the input, the nearer end is used.
/// Arrays     Ids, ghost flags and texts come from the earlier step, since they are names and not amounts.
/// Pieces     If a piece is requested, the filter asks its input for one more ghost level, so that the normals along
///            seams have the bits of the whole mesh; ghost cells that were not requested are removed again.
/// Errors     The filter reports an error and returns an empty output if the cells of a mesh differ between the two
///            steps, if normals belong to data other than vtkPolyData, or if blocks are missing in one of the steps.
#ifndef vtkChronormalInterpolator_h
#define vtkChronormalInterpolator_h

#include <array>
#include <vector>

#include "vtkChronormalModule.h"
#include "vtkTemporalInterpolator.h"

class vtkCompositeDataSet;
class vtkDataSet;

class VTKCHRONORMAL_EXPORT vtkChronormalInterpolator : public vtkTemporalInterpolator {
 public:
  static vtkChronormalInterpolator* New();
  vtkTypeMacro(vtkChronormalInterpolator, vtkTemporalInterpolator);
  void PrintSelf(ostream& os, vtkIndent indent) override;
  vtkChronormalInterpolator(const vtkChronormalInterpolator&) = delete;
  void operator=(const vtkChronormalInterpolator&) = delete;

  /// Sets whether normals of points are also computed for data without stored normals of points. On by default.
  vtkSetMacro(ComputePointNormals, bool);
  vtkGetMacro(ComputePointNormals, bool);
  vtkBooleanMacro(ComputePointNormals, bool);

  /// Sets whether normals of cells are also computed for data without stored normals of cells. Off by default.
  vtkSetMacro(ComputeCellNormals, bool);
  vtkGetMacro(ComputeCellNormals, bool);
  vtkBooleanMacro(ComputeCellNormals, bool);

  /// Selects the path of points between steps: straight lines (the default) or curves.
  enum { LINEAR = 0, CATMULL_ROM = 1 };
  vtkSetClampMacro(Path, int, LINEAR, CATMULL_ROM);
  vtkGetMacro(Path, int);
  void SetPathToLinear() { this->SetPath(LINEAR); }
  void SetPathToCatmullRom() { this->SetPath(CATMULL_ROM); }

 protected:
  vtkChronormalInterpolator() = default;
  ~vtkChronormalInterpolator() override = default;

  vtkTypeBool ProcessRequest(vtkInformation* request, vtkInformationVector** inputs,
                             vtkInformationVector* outputs) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int Execute(vtkInformation* request, const std::vector<vtkSmartPointer<vtkDataObject>>& inputs,
              vtkInformationVector* outputVector) override;

 private:
  struct Request;
  template <class Data>
  using Steps = std::vector<Data*>;

  vtkSmartPointer<vtkDataObject> Interpolate(const Steps<vtkDataObject>& steps, const Request& request);
  vtkSmartPointer<vtkDataObject> InterpolateBlocks(const Steps<vtkCompositeDataSet>& steps, const Request& request);
  vtkSmartPointer<vtkDataSet> InterpolateMesh(const Steps<vtkDataSet>& steps, const Request& request);

  bool ComputePointNormals = true;
  bool ComputeCellNormals = false;
  int Path = LINEAR;
  // The piece to which the kept steps belong: its number, the number of pieces, and the ghost levels.
  std::array<int, 3> KeptPiece = {0, 1, 0};
};

#endif
