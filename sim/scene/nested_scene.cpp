// A scene as one piece of another: fixed things within what rays are cast into.
//
// Embree's packages know one level of instances, and that is taken by the things themselves. So the
// scene of fixed things is a user geometry, whose callback casts the same rays into it. A packet
// stays a packet. Hits come back as of plain meshes: to the instance's number that of the part is
// added, so that it alone tells the surface.
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {
namespace {

RTCScene inner_of(void* user) {
  return static_cast<RTCScene>(user);
}

void bounds_of_piece(const RTCBoundsFunctionArguments* arguments) {
  rtcGetSceneBounds(inner_of(arguments->geometryUserPtr), arguments->bounds_o);
}

void name_part(RTCHit& hit) {
  if (hit.geomID != RTC_INVALID_GEOMETRY_ID) {
    hit.instID[0] += hit.geomID;
    hit.geomID = 0;
  }
}

template <class Packet>
void name_parts(const int* valid, unsigned count, Packet& packet) {
  for (unsigned i = 0; i < count; ++i) {
    if (valid[i] == -1 && packet.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID) {
      packet.hit.instID[0][i] += packet.hit.geomID[i];
      packet.hit.geomID[i] = 0;
    }
  }
}

void intersect_piece(const RTCIntersectFunctionNArguments* a) {
  RTCScene inner = inner_of(a->geometryUserPtr);
  switch (a->N) {
    case 1:
      rtcIntersect1(inner, a->context, reinterpret_cast<RTCRayHit*>(a->rayhit));
      name_part(reinterpret_cast<RTCRayHit*>(a->rayhit)->hit);
      return;
    case 4:
      rtcIntersect4(a->valid, inner, a->context, reinterpret_cast<RTCRayHit4*>(a->rayhit));
      name_parts(a->valid, 4, *reinterpret_cast<RTCRayHit4*>(a->rayhit));
      return;
    case 8:
      rtcIntersect8(a->valid, inner, a->context, reinterpret_cast<RTCRayHit8*>(a->rayhit));
      name_parts(a->valid, 8, *reinterpret_cast<RTCRayHit8*>(a->rayhit));
      return;
    case 16:
      rtcIntersect16(a->valid, inner, a->context, reinterpret_cast<RTCRayHit16*>(a->rayhit));
      name_parts(a->valid, 16, *reinterpret_cast<RTCRayHit16*>(a->rayhit));
      return;
    default:
      break;
  }
  for (unsigned i = 0; i < a->N; ++i) {
    if (a->valid[i] != -1) {
      continue;
    }
    RTCRayHit one = rtcGetRayHitFromRayHitN(a->rayhit, a->N, i);
    rtcIntersect1(inner, a->context, &one);
    name_part(one.hit);
    if (one.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
      RTCRayN* rays = RTCRayHitN_RayN(a->rayhit, a->N);
      RTCRayN_tfar(rays, a->N, i) = one.ray.tfar;
      rtcCopyHitToHitN(RTCRayHitN_HitN(a->rayhit, a->N), &one.hit, a->N, i);
    }
  }
}

void occlude_piece(const RTCOccludedFunctionNArguments* a) {
  RTCScene inner = inner_of(a->geometryUserPtr);
  switch (a->N) {
    case 1:
      rtcOccluded1(inner, a->context, reinterpret_cast<RTCRay*>(a->ray));
      return;
    case 4:
      rtcOccluded4(a->valid, inner, a->context, reinterpret_cast<RTCRay4*>(a->ray));
      return;
    case 8:
      rtcOccluded8(a->valid, inner, a->context, reinterpret_cast<RTCRay8*>(a->ray));
      return;
    case 16:
      rtcOccluded16(a->valid, inner, a->context, reinterpret_cast<RTCRay16*>(a->ray));
      return;
    default:
      break;
  }
  for (unsigned i = 0; i < a->N; ++i) {
    if (a->valid[i] == -1) {
      RTCRay one = rtcGetRayFromRayN(a->ray, a->N, i);
      rtcOccluded1(inner, a->context, &one);
      RTCRayN_tfar(a->ray, a->N, i) = one.tfar;
    }
  }
}

}  // namespace

void Scene::Internals::show_fixed() {
  RTCBounds bounds{};
  rtcGetSceneBounds(fixed.get(), &bounds);
  if (!(bounds.lower_x <= bounds.upper_x)) {
    return;  // nothing stands there
  }
  if (!as_piece) {
    as_piece.reset(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_USER));
    rtcSetGeometryUserPrimitiveCount(as_piece.get(), 1);
    rtcSetGeometryUserData(as_piece.get(), fixed.get());
    rtcSetGeometryBoundsFunction(as_piece.get(), bounds_of_piece, nullptr);
    rtcSetGeometryIntersectFunction(as_piece.get(), intersect_piece);
    rtcSetGeometryOccludedFunction(as_piece.get(), occlude_piece);
    rtcAttachGeometryByID(top.get(), as_piece.get(), kPieceNumber);
  }
  rtcCommitGeometry(as_piece.get());
}

}  // namespace rigwire::sim
