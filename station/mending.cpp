// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/mending.h"

#include <algorithm>
#include <initializer_list>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "acquisition/session_files.h"
#include "formats/json_text.h"
#include "formats/same_bytes.h"
#include "station/followed_word.h"
#include "station/kept_surface.h"
#include "station/package_content.h"
#include "station/plan_again.h"
#include "station/results.h"
#include "station/scan_set.h"
#include "station/selected_mesh.h"
#include "station/session_pages.h"
#include "station/session_wedges.h"

namespace dubsar {

namespace fs = std::filesystem;

namespace {

constexpr const char* kMended = "it was mended";
constexpr const char* kWedges = "analysis/wedges.json";

bool any_below(const std::vector<std::string>& names, const std::string& folder) {
  return std::ranges::any_of(names, [&](const std::string& name) { return name.starts_with(folder + "/"); });
}

bool is_named(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

/// Whole files whose place others may take, kept beside it as NAME.before-1 and so on.
class Kept {
 public:
  Kept(fs::path session, const std::vector<std::string>& whole)
      : session_(std::move(session)), whole_(whole) {}
  /// Those in the folder, but for what a person wrote.
  [[nodiscard]] Status keep(const std::string& folder);
  /// What is another one now. What is not needs nothing beside it.
  [[nodiscard]] std::vector<std::string> replaced() const;

 private:
  fs::path session_;
  std::vector<std::string> whole_;
  std::map<std::string, fs::path> aside_;
};

Status Kept::keep(const std::string& folder) {
  for (const std::string& name : whole_) {
    if (!name.starts_with(folder + "/") || is_by_hand(name)) {
      continue;
    }
    Result<fs::path> aside = session::copy_aside(session_ / name, session::kBeforeMark);
    if (!aside) {
      return std::unexpected(aside.error());
    }
    aside_.emplace(name, std::move(*aside));
  }
  return {};
}

std::vector<std::string> Kept::replaced() const {
  std::vector<std::string> out;
  for (const auto& [name, aside] : aside_) {
    std::error_code ignored;
    if (have_same_bytes(session_ / name, aside)) {
      fs::remove(aside, ignored);
    } else {
      out.push_back(name);
    }
  }
  return out;
}

/// Whether these poses give the mesh that the session kept, as far as its record tells.
bool is_of_the_mesh_before(const SessionStore& store, const std::vector<ScanPose>& poses) {
  const auto text = store.load_document("model");
  const auto model = nlohmann::json::parse(text && *text ? **text : "", nullptr, false);
  return model.is_object() && model.value("origin", nlohmann::json()) == origin_of_mesh(poses);
}

/// What is lost of mesh, wedges, pictures and pages, in this order: each tells of those before it.
class MakingAnew {
 public:
  MakingAnew(ScanSet& set, const std::vector<std::string>& lost, Kept& kept, JobContext& job)
      : set_(set), store_(*set.store), lost_(lost), kept_(kept), job_(job) {}
  [[nodiscard]] Status make();

 private:
  /// True where it is another one than that which is lost, or than the wedges are of: all that tells of it
  /// came with it then.
  [[nodiscard]] Result<bool> make_mesh();
  /// True where pages tell of others than these: they were taken back.
  [[nodiscard]] Result<bool> make_wedges();
  [[nodiscard]] Status make_pages(bool all);
  [[nodiscard]] Status plan();
  [[nodiscard]] Status keep(const std::initializer_list<const char*>& folders);

  ScanSet& set_;
  SessionStore& store_;
  const std::vector<std::string>& lost_;
  Kept& kept_;
  JobContext& job_;
  std::optional<PlannedAgain> planned_;
};

Status MakingAnew::plan() {
  Result<PlannedAgain> planned = plan_again(set_, set_.poses, job_);
  if (!planned) {
    return std::unexpected(planned.error());
  }
  planned_ = std::move(*planned);
  return {};
}

Status MakingAnew::keep(const std::initializer_list<const char*>& folders) {
  for (const char* folder : folders) {
    if (Status kept = kept_.keep(folder); !kept) {
      return kept;
    }
  }
  return {};
}

Result<bool> MakingAnew::make_mesh() {
  const Results& results = planned_->results;
  const PageFacts facts = page_facts_of(store_);
  // Wedges that are lost as well are measured on what stands then.
  const bool is_other =
      !facts.wedges.empty() &&
      (is_named(lost_, kWedges) ? !is_of_the_mesh_before(store_, results.poses)
                                : kept_wedges(store_, results.mesh) == KeptWedges::kOfAnotherSurface);
  if (Status kept = is_other ? keep({"analysis", "export"}) : Status(); !kept) {
    return std::unexpected(kept.error());
  }
  const Result<Deliverables> files =
      is_other
          ? keep_all_anew(store_, *planned_, job_)
          : keep_deliverables(store_, report_input(results, *planned_->stage, facts), {kSessionMesh}, job_);
  return files ? Result<bool>(is_other) : std::unexpected(files.error());
}

Result<bool> MakingAnew::make_wedges() {
  if (Status kept = is_named(lost_, kWedges) ? keep({"analysis", "export"}) : Status(); !kept) {
    return std::unexpected(kept.error());
  }
  return make_wedges_anew(store_, lost_, job_);
}

Status MakingAnew::make_pages(bool all) {
  if (all) {
    const Result<bool> made = keep_pages_anew(store_, *planned_, job_);
    return made ? Status() : std::unexpected(made.error());
  }
  std::vector<std::string> pages = lost_;
  std::erase(pages, kSessionMesh);
  PageFacts facts = page_facts_of(store_);
  tell_kept_wedges(facts, store_, planned_->results.mesh, job_);
  const Result<Deliverables> files =
      keep_deliverables(store_, report_input(planned_->results, *planned_->stage, facts), pages, job_);
  return files ? Status() : std::unexpected(files.error());
}

Status MakingAnew::make() {
  const bool were_taken_back = pages_are_taken_back(store_);
  const bool mesh_lost = is_named(lost_, kSessionMesh);
  const bool pages_lost = any_below(lost_, "export");
  if (Status worked_out = mesh_lost || pages_lost ? plan() : Status(); !worked_out) {
    return worked_out;
  }
  const Result<bool> all = mesh_lost ? make_mesh() : false;
  if (!all) {
    return std::unexpected(all.error());
  }
  const Result<bool> others = !*all && any_below(lost_, "analysis") ? make_wedges() : Result<bool>(false);
  if (!others) {
    return std::unexpected(others.error());
  }
  // Those that were taken back for other wedges must not stay so beside the ones that come.
  if (Status made = !*all && pages_lost ? make_pages(*others) : Status(); !made) {
    return made;
  }
  // The poses may not follow yet what was said of the scans: plan sees to that.
  const Result<std::string> not_followed = pages_lost ? not_followed_sentence(set_) : std::string();
  if (!not_followed) {
    return std::unexpected(not_followed.error());
  }
  if (!not_followed->empty()) {
    return take_pages_back(store_, *not_followed, kFollowAndPlan);
  }
  return were_taken_back && (mesh_lost || pages_lost) ? take_pages_back(store_, kMended, kFollowAndPlan)
                                                      : Status();
}

/// Returns what was whole and had to be replaced.
Result<std::vector<std::string>> make_derived_anew(const fs::path& session,
                                                   const std::vector<std::string>& whole,
                                                   const std::vector<std::string>& lost, JobContext& job) {
  Result<ScanSet> set = load_scan_set(session, {}, job);
  if (!set) {
    return std::unexpected(set.error());
  }
  Kept kept(session, whole);
  if (Status made = MakingAnew(*set, lost, kept, job).make(); !made) {
    return std::unexpected(made.error());
  }
  std::vector<std::string> replaced = kept.replaced();
  const OrderedJson what{{"restored", OrderedJson::array()}, {"made_anew", replaced}};
  const Status noted = replaced.empty() ? Status() : set->store->append_event("repaired", text_of(what));
  return noted ? Result<std::vector<std::string>>(std::move(replaced)) : std::unexpected(noted.error());
}

}  // namespace

Result<Mended> mend_session(const fs::path& session, const VerifyReport& found,
                            const std::optional<fs::path>& copy, JobContext& job) {
  Mended out;
  Result<std::vector<std::string>> kept = SessionStore::keep_damaged_records(session, found);
  if (!kept) {
    return std::unexpected(kept.error());
  }
  RepairReport repaired;
  std::string lost_scan;  // one that the derived files would lack
  {
    Result<SessionStore> store =
        copy ? SessionStore::open_with_copy(session, *copy) : SessionStore::open(session);
    if (!store) {
      return std::unexpected(store.error());
    }
    out.notes = store->opening().notes;
    out.records = store->opening().brought_back;
    if (store->opening().no_use_of_copy) {
      out.beyond.push_back(*store->opening().no_use_of_copy);
    }
    // Opened for writing, the tables are whole; what the grids and other files are is to be seen once more.
    Result<VerifyReport> now = store->verify(job);
    if (!now) {
      return std::unexpected(now.error());
    }
    Result<RepairReport> done = store->repair(*now, copy, job);
    if (!done) {
      return std::unexpected(done.error());
    }
    repaired = std::move(*done);
    const Result<std::vector<StoredScan>> scans = store->scans();
    if (!scans) {
      return std::unexpected(scans.error());
    }
    for (const StoredScan& scan : *scans) {
      lost_scan = scan.damaged && !scan.dropped && lost_scan.empty() ? scan.file : lost_scan;
    }
  }
  out.restored = repaired.restored;
  out.beyond.insert(out.beyond.end(), repaired.beyond.begin(), repaired.beyond.end());
  if (!repaired.derived.empty() && !lost_scan.empty()) {
    // It would be made of fewer scans than the one that was lost, and nobody could tell.
    for (const std::string& name : repaired.derived) {
      out.beyond.push_back({ErrorKind::kBadInput, "cannot be made anew without " + lost_scan, name,
                            "bring that back from a copy, or drop the scan, and repair again"});
    }
  } else if (!repaired.derived.empty()) {
    if (const auto made = make_derived_anew(session, found.whole, repaired.derived, job); made) {
      out.made_anew = repaired.derived;
      out.made_anew.insert(out.made_anew.end(), made->begin(), made->end());
    } else if (made.error().kind == ErrorKind::kCancelled) {
      return std::unexpected(made.error());
    } else {
      out.beyond.push_back(made.error());
    }
  }
  if (lost_scan.empty() && !(out.records.empty() && out.notes.empty())) {
    // What came back, or is lost of the record, may have been said of scans or places that the pages show.
    Result<SessionStore> store = SessionStore::open(session);
    const bool behind = store && !why_pages_are_behind(*store).empty();
    if (const Status taken = behind ? take_pages_back_once(*store, kMended, kFollowAndPlan) : Status();
        !taken) {
      out.beyond.push_back(taken.error());
    }
  }
  const Result<SessionStore> after = SessionStore::open(session, SessionStore::Access::kReadOnly);
  Result<VerifyReport> now = after ? after->verify(job) : std::unexpected(after.error());
  if (!now) {
    return std::unexpected(now.error());
  }
  std::ranges::set_difference(now->set_aside, found.set_aside, std::back_inserter(out.set_aside));
  std::erase_if(out.made_anew, [&](const std::string& name) {
    const bool is_whole = is_named(now->whole, name);
    if (!is_whole) {
      out.beyond.push_back({ErrorKind::kBadInput, "scans and places do not give it", name,
                            "bring it back from a copy (dubsar verify --repair --from COPY)"});
    }
    return !is_whole;
  });
  return out;
}

}  // namespace dubsar
