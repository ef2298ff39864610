#include <chrono>
#include <cstdio>
#include "registration/global_align.h"
#include "registration/icp.h"
#include "registration/pose_evidence.h"
#include "core/units.h"
#include "tests/registration/support/read_range_ply.h"
using namespace dubsar;
using Clock = std::chrono::steady_clock;
static double since(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }
int main(int argc, char** argv) {
  const std::string folder = argc > 1 ? argv[1] : "/work/shared/data/stanford_bunny";
  const std::string conf = argc > 2 ? argv[2] : "bun.conf";
  auto grids = testing::read_folder(folder, 1000);
  auto truth = testing::read_conf(folder + "/" + conf, 1000);
  auto t0 = Clock::now();
  std::vector<ScanFeatures> f;
  double scale = 0;
  for (auto& g : grids) {
    if (scale == 0) scale = surface_scale_mm(g);
    ScanSurfaceOptions o; o.scale_mm = scale;
    ScanFeatures x; x.surface = make_scan_surface(g, {}, o);
    auto t1 = Clock::now();
    x.descriptors = RingDescriptors(*x.surface, scale, {});
    auto& s = *x.surface;
    printf("%s mu %.3f noise %.3f scale %.1f own %.1f valid %zu fine %.2f med %.2f coarse %.2f samples %zu %zu %zu kp %zu (%.3f s)\n", g.source.c_str(), s.spacing_mm, s.noise_mm, scale, surface_scale_mm(g), s.valid, s.fine->spacing_mm, s.medium->spacing_mm, s.coarse->spacing_mm, s.fine->samples.size(), s.medium->samples.size(), s.coarse->samples.size(), x.descriptors.size(), since(t1));
    f.push_back(std::move(x));
  }
  printf("features %.3f s\n", since(t0));
  GlobalAlignOptions options;
  int good = 0, of = 0; double total = 0;
  for (size_t i = 0; i < f.size(); ++i) for (size_t j = 0; j < i; ++j) {
    auto t1 = Clock::now();
    auto h = align_pair(f[i], f[j], options);
    total += since(t1);
    RigidTransform t = truth[grids[j].source].inverse() * truth[grids[i].source];
    auto& si = *f[i].surface; auto& sj = *f[j].surface;
    double sig = std::sqrt(si.noise_mm*si.noise_mm+sj.noise_mm*sj.noise_mm+0.04*si.fine->spacing_mm*si.fine->spacing_mm);
    EvidenceOptions eo; eo.tolerance_mm = 3*sig; eo.band_mm = 0.08*scale;
    auto show = [&](const RigidTransform& T, const char* name, double score) {
      RigidTransform e = t.inverse() * T;
      double mm = (T * si.centroid_mm - t * si.centroid_mm).norm();
      IcpResult r; r.model_from_source = T;
      if (1) { IcpOptions io; IcpTarget m{sj.medium.get(), {}}; 
        for (double reach : {0.04, 0.015}) { io.reach_mm = reach*scale; io.kernel_mm=0.15*reach*scale; io.two_way=true; io.iterations=15; r = icp(*si.medium, {&m,1}, r.model_from_source, io); }
        IcpTarget n{sj.fine.get(), {}}; io.reach_mm = 3*si.spacing_mm; io.kernel_mm = 1.5*sig; r = icp(*si.fine, {&n,1}, r.model_from_source, io); }
      auto ev = pose_evidence(*si.fine, *sj.fine, r.model_from_source, eo); auto e2 = pose_evidence(*sj.fine, *si.fine, r.model_from_source.inverse(), eo);
      RigidTransform e3 = t.inverse() * r.model_from_source;
      double mm3 = (r.model_from_source * si.centroid_mm - t * si.centroid_mm).norm();
      printf("   %s score %.3f err %.1f deg %.1f mm -> %.2f deg %.2f mm | ov %.3f %.3f agree %.2f %.2f viol %.3f %.3f miss %.2f %.2f rms %.3f stab %.4f\n", name, score, deg_from_rad(e.angle_rad()), mm, deg_from_rad(e3.angle_rad()), mm3, (double)ev.close/ev.sent, (double)e2.close/e2.sent, ev.agreement(), e2.agreement(), ev.violation(), e2.violation(), (double)ev.missing/(ev.missing+ev.close+1), (double)e2.missing/(e2.missing+e2.close+1), r.rms_mm, r.stability);
      return deg_from_rad(e3.angle_rad()) < 1.5 && mm3 < 1.5;
    };
    auto ev = pose_evidence(*si.fine, *sj.fine, t, eo); auto e2 = pose_evidence(*sj.fine, *si.fine, t.inverse(), eo);
    double ov = std::max((double)ev.close/ev.sent, (double)e2.close/e2.sent);
    printf("%s %s true ov %.3f %.3f\n", grids[i].source.c_str(), grids[j].source.c_str(), (double)ev.close/ev.sent, (double)e2.close/e2.sent);
    show(t, "true", 0);
    bool any = false;
    for (size_t k = 0; k < h.size() && k < 3; ++k) { bool g = show(h[k].target_from_source, "hyp", h[k].score); any |= g; }
    if (ov > 0.25) { ++of; good += any; }
  }
  printf("pairs with overlap>0.25: %d of %d found; align_pair %.3f s total\n", good, of, total);
}
