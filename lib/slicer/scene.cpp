// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/scene.h"

#include <cmath>

#include "base/joined.h"
#include "base/pi.h"
#include "base/text.h"
#include "meshio/zip_bundle.h"
#include "slicer/mrml.h"
#include "slicer/segmentation.h"

namespace trephine::slicer {
namespace {

Vec3 ras(Vec3 lps) { return {-lps.x, -lps.y, lps.z}; }

std::string in_a_row(const std::vector<double>& numbers) {
  return joined(numbers, " ", [](const double n) { return to_text(n + 0.0); });
}
std::string text_of(Vec3 v) { return in_a_row({v.x, v.y, v.z}); }
std::string text_of(const std::array<double, 3>& c) { return in_a_row({c[0], c[1], c[2]}); }

void add_models(Mrml& mrml, const CaseScene& scene, std::vector<meshio::ExportFile>& files) {
  for (const SceneModel& m : scene.models) {
    const std::string file = "Data/" + m.name + ".vtp";
    files.push_back({file, m.vtp});
    // The file's points have the colour too; the one of the display node is what the user of Slicer can change.
    const std::string display = mrml.add("ModelDisplay", "vtkMRMLModelDisplayNode", m.name + "_display",
                                         {{"color", text_of(m.colour_rgb)},
                                          {"opacity", to_text(m.opacity)},
                                          {"visibility", "true"},
                                          {"visibility2D", "true"},
                                          {"visibility3D", "true"},
                                          {"sliceIntersectionThickness", "1"},
                                          {"scalarVisibility", "false"},
                                          {"backfaceCulling", "false"},
                                          {"interpolation", "1"}});
    const std::string storage = mrml.add("ModelStorage", "vtkMRMLModelStorageNode", m.name + "_storage",
                                         {{"fileName", file}, {"useCompression", "0"}, {"coordinateSystem", "LPS"}});
    mrml.add_data("Model", "vtkMRMLModelNode", m.name, display, storage, {});
  }
}

std::string add_ct(Mrml& mrml, const CaseScene& scene, std::vector<meshio::ExportFile>& files) {
  if (scene.ct_nrrd.empty()) return "";
  files.push_back({"Data/ct.nrrd", scene.ct_nrrd});
  const std::string display = mrml.add("VolumeDisplay", "vtkMRMLScalarVolumeDisplayNode", "ct_display",
                                       {{"colorNodeID", "vtkMRMLColorTableNodeGrey"},
                                        {"references", "color:vtkMRMLColorTableNodeGrey;"},
                                        {"window", "400"},
                                        {"level", "40"},
                                        {"autoWindowLevel", "0"},
                                        {"interpolate", "1"}});
  const std::string storage = mrml.add(
      "VolumeArchetypeStorage", "vtkMRMLVolumeArchetypeStorageNode", "ct_storage",
      {{"fileName", "Data/ct.nrrd"}, {"useCompression", "1"}, {"centerImage", "0"}, {"UseOrientationFromFile", "1"}});
  std::string rows;
  for (int r = 0; r < 3; ++r)
    rows += (r ? " " : "") + in_a_row({ras(scene.ct.direction.column[0])[r], ras(scene.ct.direction.column[1])[r],
                                       ras(scene.ct.direction.column[2])[r]});
  return mrml.add_data("Volume", "vtkMRMLScalarVolumeNode", "ct", display, storage,
                       {{"ijkToRASDirections", rows},
                        {"spacing", text_of(scene.ct.spacing_mm)},
                        {"origin", text_of(ras(scene.ct.origin_mm))}});
}

// In the slices alone: in 3D the models are shown, which are finer.
void add_segmentation(Mrml& mrml, const CaseScene& scene, const std::string& volume,
                      std::vector<meshio::ExportFile>& files) {
  if (scene.segments.empty()) return;
  files.push_back({"Data/segmentation.seg.nrrd", encode_segmentation(scene.segmented, scene.segments)});
  const std::string display = mrml.add("SegmentationDisplay", "vtkMRMLSegmentationDisplayNode", "segmentation_display",
                                       {{"visibility", "true"},
                                        {"visibility2D", "true"},
                                        {"visibility3D", "false"},
                                        {"PreferredDisplayRepresentationName2D", "Binary labelmap"},
                                        {"Visibility2DFill", "true"},
                                        {"Visibility2DOutline", "true"},
                                        {"Opacity2DFill", "0.3"}});
  const std::string storage = mrml.add("SegmentationStorage", "vtkMRMLSegmentationStorageNode", "segmentation_storage",
                                       {{"fileName", "Data/segmentation.seg.nrrd"}, {"useCompression", "1"}});
  mrml.add_data("Segmentation", "vtkMRMLSegmentationNode", "segmentation", display, storage, {},
                volume.empty() ? "" : "referenceImageGeometryRef:" + volume + ";");
}

void add_markup(Mrml& mrml, const meshio::Markup& m, double diameter_mm, std::vector<meshio::ExportFile>& files) {
  const std::string file = "Data/" + m.name + ".mrk.json";
  files.push_back({file, meshio::encode_slicer_markups(m)});
  Mrml::Attributes shown{{"color", text_of(m.colour_rgb)},
                         {"selectedColor", text_of(m.colour_rgb)},
                         {"visibility", "true"},
                         {"visibility2D", "true"},
                         {"visibility3D", "true"},
                         {"pointLabelsVisibility", m.line ? "false" : "true"},
                         {"propertiesLabelVisibility", "true"}};
  if (diameter_mm > 0) {
    shown.emplace_back("curveLineSizeMode", "UseLineDiameter");
    shown.emplace_back("lineDiameter", to_text(diameter_mm));
    shown.emplace_back("opacity", "0.5");
  }
  const std::string kind = m.line ? "Line" : "Fiducial";
  const std::string display =
      mrml.add(m.line ? "MarkupsDisplay" : "MarkupsFiducialDisplay",
               m.line ? "vtkMRMLMarkupsDisplayNode" : "vtkMRMLMarkupsFiducialDisplayNode", m.name + "_display", shown);
  const std::string storage = mrml.add("MarkupsJsonStorage", "vtkMRMLMarkupsJsonStorageNode", m.name + "_storage",
                                       {{"fileName", file}, {"useCompression", "0"}, {"coordinateSystem", "LPS"}});
  mrml.add_data("Markups" + kind, "vtkMRMLMarkups" + kind + "Node", m.name, display, storage, {{"locked", "1"}});
}

struct SliceView {
  const char *name, *orientation;
  Vec3 right, up, out;  ///< RAS
};
constexpr double view_angle_deg = 30, look_mm = 500;  // VTK's own camera; a distance for a scene without surfaces

// Three slices through the middle, and a camera in front of the patient, a little above and to the left.
void add_views(Mrml& mrml, const CaseScene& scene, const std::string& volume) {
  const bool any = scene.bounds_mm.min_mm.x <= scene.bounds_mm.max_mm.x;
  const Vec3 middle = any ? ras((scene.bounds_mm.min_mm + scene.bounds_mm.max_mm) / 2) : Vec3{};
  const double across = any ? norm(scene.bounds_mm.max_mm - scene.bounds_mm.min_mm) : 0;
  const double far = across > 0 ? 0.5 * across / std::sin(view_angle_deg / 2 * pi / 180) : look_mm;
  const Vec3 from = normalized(Vec3{-0.35, 0.85, 0.4});
  const std::string wide = to_text(std::ceil(across > 0 ? across : 250));
  const SliceView views[] = {{"Red", "Axial", {-1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                             {"Yellow", "Sagittal", {0, -1, 0}, {0, 0, 1}, {1, 0, 0}},
                             {"Green", "Coronal", {-1, 0, 0}, {0, 0, 1}, {0, 1, 0}}};
  mrml.add_singleton("Layout", "vtkMRMLLayoutNode", "vtkMRMLLayoutNode", "Layout", {{"currentViewArrangement", "3"}});
  mrml.add_singleton(
      "View", "vtkMRMLViewNode", "1", "View1",
      {{"layoutLabel", "1"}, {"layoutName", "1"}, {"boxVisible", "true"}, {"axisLabelsVisible", "true"}});
  for (const SliceView& v : views) {
    std::string matrix;
    for (int r = 0; r < 3; ++r) matrix += in_a_row({v.right[r], v.up[r], v.out[r], middle[r]}) + " ";
    mrml.add_singleton("Slice", "vtkMRMLSliceNode", v.name, v.name,
                       {{"layoutName", v.name},
                        {"orientation", v.orientation},
                        {"sliceToRAS", matrix + "0 0 0 1"},
                        {"fieldOfView", wide + " " + wide + " 1"},
                        {"dimensions", "512 512 1"}});
    mrml.add_singleton("SliceComposite", "vtkMRMLSliceCompositeNode", v.name, "SliceComposite",
                       {{"layoutName", v.name}, {"backgroundVolumeID", volume}, {"linkedControl", "1"}});
  }
  mrml.add("Camera", "vtkMRMLCameraNode", "Camera",
           {{"position", text_of(middle + from * far)},
            {"focalPoint", text_of(middle)},
            {"viewUp", text_of(normalized(Vec3{0, 0, 1} - from * from.z))},
            {"parallelProjection", "false"},
            {"parallelScale", "1"},
            {"layoutName", "1"},
            {"activetag", "vtkMRMLViewNode1"}});
}

}  // namespace

std::string encode_scene(const CaseScene& scene) {
  Mrml mrml;
  std::vector<meshio::ExportFile> files;
  const std::string volume = add_ct(mrml, scene, files);
  mrml.add_units(volume);
  add_views(mrml, scene, volume);
  add_models(mrml, scene, files);
  add_segmentation(mrml, scene, volume, files);
  for (const meshio::Markup& m : scene.markups) add_markup(mrml, m, 0, files);
  for (const SceneHole& h : scene.holes) add_markup(mrml, h.line, h.diameter_mm, files);
  files.insert(files.begin(), {scene.name + ".mrml", mrml.text(scene.program)});
  return meshio::bundle_of(scene.name, files);
}

}  // namespace trephine::slicer
