// SPDX-License-Identifier: GPL-3.0-or-later
// sdf_check FILE: what Debian's libsdformat reads of a model, a line each. solids.sh compiles it where that is
// installed.
#include <cstdio>
#include <sdf/sdf.hh>

int main(int, char** argv) {
  sdf::setFindCallback([&](const std::string& uri) { return uri; });
  sdf::Root root;
  for (const sdf::Error& e : root.Load(argv[1])) std::printf("error %s\n", e.Message().c_str());
  const sdf::Model* model = root.Model();
  if (!model) return 1;
  std::printf("model %s static %d\n", model->Name().c_str(), model->Static());
  for (std::uint64_t n = 0; n < model->LinkCount(); ++n) {
    const sdf::Link* link = model->LinkByIndex(n);
    const auto& mass = link->Inertial().MassMatrix();
    const auto at = link->Inertial().Pose().Pos();
    const auto i = mass.Moi();
    std::printf("link %s mass %.9g valid %d centre %.9g %.9g %.9g inertia %.9g %.9g %.9g %.9g %.9g %.9g\n",
                link->Name().c_str(), mass.Mass(), mass.IsValid(), at.X(), at.Y(), at.Z(), i(0, 0), i(1, 1), i(2, 2),
                i(0, 1), i(0, 2), i(1, 2));
    const auto say = [](const char* what, const auto* part) {
      ignition::math::Pose3d pose;
      for (const sdf::Error& e : part->SemanticPose().Resolve(pose, "__model__"))
        std::printf("error %s\n", e.Message().c_str());
      const sdf::Mesh* mesh = part->Geom()->MeshShape();
      const auto p = pose.CoordPositionAdd(mesh->Scale() * ignition::math::Vector3d(1000, 2000, 3000));
      std::printf("%s %s %s at %.9g %.9g %.9g\n", what, part->Name().c_str(), mesh->Uri().c_str(), p.X(), p.Y(), p.Z());
    };
    for (std::uint64_t v = 0; v < link->VisualCount(); ++v) {
      say("visual", link->VisualByIndex(v));
      const auto c = link->VisualByIndex(v)->Material()->Diffuse();
      std::printf("colour %.6g %.6g %.6g transparency %.6g\n", double(c.R()), double(c.G()), double(c.B()),
                  double(link->VisualByIndex(v)->Transparency()));
    }
    for (std::uint64_t c = 0; c < link->CollisionCount(); ++c) say("collision", link->CollisionByIndex(c));
  }
}
