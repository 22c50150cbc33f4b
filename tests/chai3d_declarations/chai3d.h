// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What examples/chai3d_peer uses of CHAI3D 3.3, as its headers declare it, so that the example is compiled with every
// build. There is nothing behind these declarations.
#include <memory>

namespace chai3d {

struct cVector3d {
  cVector3d() {}
  cVector3d(const double x, const double y, const double z);
  double x() const;
  double y() const;
  double z() const;
};
struct cMatrix3d {};
cMatrix3d cIdentity3d();
struct cColorf {
  cColorf(float r, float g, float b, float a);
};
class cMaterial;

class cGenericObject {
 public:
  cGenericObject();
  virtual ~cGenericObject();
  virtual void computeGlobalPositions(const bool frame_only = true, const cVector3d& position = cVector3d(0, 0, 0),
                                      const cMatrix3d& rotation = cIdentity3d());
  virtual void setHapticEnabled(const bool enabled, const bool children = true, const bool components = true);
  virtual void setStiffness(const double stiffness, const bool children = true, const bool components = true);
  bool addChild(cGenericObject* object);
};

class cMesh : public cGenericObject {
 public:
  cMesh(std::shared_ptr<cMaterial> material = nullptr);
  unsigned int newVertex(const double x = 0, const double y = 0, const double z = 0, const double normal_x = 1,
                         const double normal_y = 0, const double normal_z = 0, const double texture_x = 0,
                         const double texture_y = 0, const double texture_z = 0);
  unsigned int newVertex(const cVector3d& position, const cVector3d& normal = cVector3d(1, 0, 0),
                         const cVector3d& texture = cVector3d(0, 0, 0), const cColorf& colour = cColorf(0, 0, 0, 1));
  unsigned int newTriangle(const unsigned int a, const unsigned int b, const unsigned int c);
  void computeAllNormals();
  virtual void createAABBCollisionDetector(const double radius);
};

class cWorld : public cGenericObject {
 public:
  cWorld();
};

class cAlgorithmFingerProxy {
 public:
  cAlgorithmFingerProxy();
  virtual ~cAlgorithmFingerProxy();
  void initialize(cWorld* world, const cVector3d& position);
  virtual cVector3d computeForces(const cVector3d& position, const cVector3d& velocity);
  void setProxyRadius(const double& radius);
  cVector3d getProxyGlobalPosition() const;
};

}  // namespace chai3d
