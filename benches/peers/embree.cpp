// Embree 3 beside nullray, for the benchmark `peers`, which compiles and starts this: one thread, one mesh.
//
//   embree MESH.tri DISTANCE HALF_WIDTH SIZE
//
// MESH.tri: little-endian f32, nine per triangle. The camera looks along -z from c + (0, 0, DISTANCE R), with c the centre of the
// bounding box and R half its diagonal, HALF_WIDTH of the image plane at distance 1, through the centres of SIZE x SIZE pixels.
// For each line of the input, one of "closest 1", "closest 8", "closest 16", "shuffled 1", "random 1", "random 16", "shadow 1", "shadow 16", all rays are traced once, and
// a line of the output says how long that took in seconds and how many rays hit something. The first line says how long the
// tree took to build, at Embree's highest quality and at its medium one. Shuffled rays are those to every 40,503rd pixel,
// random ones go from any point of the bounding box any way, as many as there are pixels. Shadow rays go from what is seen to c + (0.5, 0.8, 0.6) R.
#include <embree3/rtcore.h>
#include <pmmintrin.h>
#include <xmmintrin.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

using Clock = std::chrono::steady_clock;

struct Ray {
  float origin[3], direction[3], near, far;
};

static double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

static RTCScene scene_of(RTCDevice device, const std::vector<float>& t, RTCBuildQuality quality, double& seconds) {
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneBuildQuality(scene, quality);
  RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  size_t n = t.size() / 9;
  memcpy(rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, n * 3), t.data(), n * 36);
  unsigned* index = (unsigned*)rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, n);
  for (size_t i = 0; i < n * 3; i++) index[i] = (unsigned)i;
  rtcSetGeometryBuildQuality(g, quality);
  rtcCommitGeometry(g);
  rtcAttachGeometry(scene, g);
  auto begin = Clock::now();
  rtcCommitScene(scene);
  seconds = seconds_since(begin);
  return scene;
}

// Packets of N rays, filled from an array as a renderer fills them.
template <class Packet, int N, class Trace>
static size_t packets(const std::vector<Ray>& rays, Trace trace) {
  size_t hits = 0;
  for (size_t first = 0; first < rays.size(); first += N) {
    alignas(64) Packet p;
    alignas(64) int valid[N];
    for (int k = 0; k < N; k++) {
      valid[k] = first + k < rays.size() ? -1 : 0;
      const Ray& r = rays[std::min(first + k, rays.size() - 1)];
      p.ray.org_x[k] = r.origin[0], p.ray.org_y[k] = r.origin[1], p.ray.org_z[k] = r.origin[2];
      p.ray.dir_x[k] = r.direction[0], p.ray.dir_y[k] = r.direction[1], p.ray.dir_z[k] = r.direction[2];
      p.ray.tnear[k] = r.near, p.ray.tfar[k] = r.far;
      p.ray.mask[k] = -1, p.ray.flags[k] = 0, p.ray.time[k] = 0;
      p.hit.geomID[k] = p.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
    }
    hits += trace(valid, p);
  }
  return hits;
}

int main(int argc, char** argv) {
  if (argc != 5) return fprintf(stderr, "usage: embree MESH.tri DISTANCE HALF_WIDTH SIZE\n"), 2;
  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
  _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
  float distance = (float)atof(argv[2]), half_width = (float)atof(argv[3]);
  int size = atoi(argv[4]);
  FILE* f = fopen(argv[1], "rb");
  if (!f) return perror(argv[1]), 2;
  fseek(f, 0, SEEK_END);
  std::vector<float> t((size_t)ftell(f) / 4);
  rewind(f);
  if (fread(t.data(), 4, t.size(), f) != t.size()) return 2;
  float lo[3] = {1e30f, 1e30f, 1e30f}, hi[3] = {-1e30f, -1e30f, -1e30f}, c[3];
  for (size_t i = 0; i < t.size(); i++) lo[i % 3] = std::min(lo[i % 3], t[i]), hi[i % 3] = std::max(hi[i % 3], t[i]);
  float radius = 0;
  for (int i = 0; i < 3; i++) c[i] = (lo[i] + hi[i]) / 2, radius += (hi[i] - lo[i]) * (hi[i] - lo[i]) / 4;
  radius = std::sqrt(radius);

  RTCDevice device = rtcNewDevice("threads=1,user_threads=1");
  double high, medium;
  RTCScene scene = scene_of(device, t, RTC_BUILD_QUALITY_HIGH, high);
  rtcReleaseScene(scene_of(device, t, RTC_BUILD_QUALITY_MEDIUM, medium));

  // 4 x 4 pixels after each other, so that packets of 16 and of 8 are compact.
  std::vector<Ray> rays, shuffled, shadows;
  for (int block = 0; block < size * size / 16; block++)
    for (int k = 0; k < 16; k++) {
      int x = block % (size / 4) * 4 + k % 4, y = block / (size / 4) * 4 + k / 4;
      float px = ((x + .5f) / size * 2 - 1) * half_width, py = (1 - (y + .5f) / size * 2) * half_width;
      float l = 1 / std::sqrt(px * px + py * py + 1);
      rays.push_back({{c[0], c[1], c[2] + distance * radius}, {px * l, py * l, -l}, 0, 1e30f});
    }
  for (size_t i = 0, at = 0; i < rays.size(); i++, at = (at + 40503) % rays.size()) shuffled.push_back(rays[at]);
  // The numbers of `random_rays` in peers.rs.
  std::vector<Ray> random;
  unsigned long long state = 1;
  auto next = [&] {
    state = state * 6364136223846793005ull + 1;
    return (state >> 11) / (double)(1ull << 53);
  };
  while (random.size() < rays.size()) {
    double o[3], d[3], l = 0;
    for (int i = 0; i < 3; i++) o[i] = lo[i] + ((double)hi[i] - lo[i]) * next();
    for (int i = 0; i < 3; i++) d[i] = next() * 2 - 1, l += d[i] * d[i];
    if (l > 1 || l < 1e-4) continue;
    l = std::sqrt(l);
    random.push_back({{(float)o[0], (float)o[1], (float)o[2]}, {(float)(d[0] / l), (float)(d[1] / l), (float)(d[2] / l)}, 0, 1e30f});
  }
  RTCIntersectContext coherent, incoherent, single;
  rtcInitIntersectContext(&coherent), rtcInitIntersectContext(&incoherent), rtcInitIntersectContext(&single);
  coherent.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  auto closest = [&](const Ray& r, float& at) {
    RTCRayHit p;
    p.ray.org_x = r.origin[0], p.ray.org_y = r.origin[1], p.ray.org_z = r.origin[2];
    p.ray.dir_x = r.direction[0], p.ray.dir_y = r.direction[1], p.ray.dir_z = r.direction[2];
    p.ray.tnear = r.near, p.ray.tfar = r.far, p.ray.mask = -1, p.ray.flags = 0, p.ray.time = 0;
    p.hit.geomID = p.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene, &single, &p);
    at = p.ray.tfar;
    return p.hit.geomID != RTC_INVALID_GEOMETRY_ID;
  };
  for (const Ray& r : rays) {
    float at;
    if (!closest(r, at)) continue;
    Ray s;
    for (int i = 0; i < 3; i++) {
      s.origin[i] = r.origin[i] + at * r.direction[i];
      s.direction[i] = c[i] + (i == 0 ? .5f : i == 1 ? .8f : .6f) * radius - s.origin[i];
    }
    s.near = 1e-4f, s.far = 1;
    shadows.push_back(s);
  }
  printf("built %.6f %.6f\n", high, medium), fflush(stdout);

  char kind[16];
  int width;
  while (scanf("%15s %d", kind, &width) == 2) {
    bool shadow = std::string(kind) == "shadow";
    bool any_way = std::string(kind) == "random";
    const std::vector<Ray>& traced = shadow ? shadows : any_way ? random : std::string(kind) == "shuffled" ? shuffled : rays;
    size_t hits = 0;
    auto begin = Clock::now();
    auto count = [](auto& p, int n) {
      size_t hits = 0;
      for (int k = 0; k < n; k++) hits += p.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID;
      return hits;
    };
    auto blocked = [](auto& p, int* valid, int n) {
      size_t hits = 0;
      for (int k = 0; k < n; k++) hits += valid[k] && p.ray.tfar[k] < 0;
      return hits;
    };
    if (width == 16 && shadow)
      hits = packets<RTCRayHit16, 16>(traced, [&](int* v, RTCRayHit16& p) {
        return rtcOccluded16(v, scene, &coherent, (RTCRay16*)&p.ray), blocked(p, v, 16);
      });
    else if (width == 16)
      hits = packets<RTCRayHit16, 16>(traced, [&](int* v, RTCRayHit16& p) {
        return rtcIntersect16(v, scene, any_way ? &incoherent : &coherent, &p), count(p, 16);
      });
    else if (width == 8)
      hits = packets<RTCRayHit8, 8>(traced, [&](int* v, RTCRayHit8& p) {
        return rtcIntersect8(v, scene, &coherent, &p), count(p, 8);
      });
    else if (shadow)
      for (const Ray& r : traced) {
        RTCRay p;
        p.org_x = r.origin[0], p.org_y = r.origin[1], p.org_z = r.origin[2];
        p.dir_x = r.direction[0], p.dir_y = r.direction[1], p.dir_z = r.direction[2];
        p.tnear = r.near, p.tfar = r.far, p.mask = -1, p.flags = 0, p.time = 0;
        rtcOccluded1(scene, &single, &p);
        hits += p.tfar < 0;
      }
    else
      for (const Ray& r : traced) {
        float at;
        hits += closest(r, at);
      }
    printf("%.9f %zu\n", seconds_since(begin), hits), fflush(stdout);
  }
}
