/* Lets rays of Debian 12's Open3D hit something: Open3D 0.16 leaves the mask of its rays at 0, and
 * Debian's Embree is built with ray masks, so that they pass through everything. Preloaded by
 * scripts/lidar-peer.py.
 */
#include <dlfcn.h>
#include <embree3/rtcore.h>
#include <stddef.h>

void rtcIntersect1M(RTCScene scene, struct RTCIntersectContext* context, struct RTCRayHit* rays,
                    unsigned int count, size_t stride) {
  typedef void (*Intersect)(RTCScene, struct RTCIntersectContext*, struct RTCRayHit*, unsigned int,
                            size_t);
  static Intersect embree;
  if (embree == NULL) {
    embree = (Intersect)dlsym(dlopen("libembree3.so.3", RTLD_NOW), "rtcIntersect1M");
  }
  for (unsigned int i = 0; i < count; ++i) {
    ((struct RTCRayHit*)((char*)rays + i * stride))->ray.mask = 0xFFFFFFFFU;
  }
  embree(scene, context, rays, count, stride);
}
