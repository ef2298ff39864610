// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/mesh_viewing.h"

#include <utility>

#include "acquisition/session_store.h"
#include "analysis/body_fields.h"
#include "analysis/curvature.h"
#include "analysis/vertex_geometry.h"
#include "core/tablet_frame.h"
#include "core/thread_priority.h"
#include "formats/corrections_json.h"
#include "station/analysis.h"
#include "station/mesh_to_view.h"
#include "station/place_outside.h"
#include "station/section_file.h"
#include "station/selection_store.h"
#include "station/tablet_label.h"
#include "station/wedges_beside.h"

namespace dubsar {

namespace fs = std::filesystem;

MeshViewing::MeshViewing(std::function<void()> on_change) : on_change_(std::move(on_change)) {
  state_.selections = std::make_shared<const std::vector<MeshSelection>>();
}

MeshViewing::~MeshViewing() {
  {
    const std::scoped_lock lock(mutex_);
    ended_ = true;
  }
  stop();
  if (worker_.joinable()) {
    worker_.join();
  }
}

ViewedMesh MeshViewing::state() const {
  const std::scoped_lock lock(mutex_);
  return state_;
}

std::shared_ptr<const Mesh> MeshViewing::mesh() const {
  const std::scoped_lock lock(mutex_);
  return state_.mesh;
}

void MeshViewing::ask(Task task, AskedBy by) {
  std::thread ended;
  {
    const std::scoped_lock lock(mutex_);
    if (ended_) {
      return;
    }
    if (by != AskedBy::kWindow) {
      state_.error.reset();  // what was refused before is no matter any more
    }
    tasks_.push_back({std::move(task), by == AskedBy::kPersonForGood});
    if (running_) {
      return;
    }
    state_.stage = "...";
    state_.fraction = 0;
    running_ = true;
    ended = std::move(worker_);
  }
  if (ended.joinable()) {
    ended.join();  // without the lock: its last change may be looked at still
  }
  worker_ = std::thread([this] { run(); });
}

void MeshViewing::run() {
  yield_this_thread();
  for (;;) {
    Waiting next;
    {
      const std::scoped_lock lock(mutex_);
      if (tasks_.empty()) {
        running_ = false;
        state_.stage.clear();
        break;
      }
      next = std::move(tasks_.front());
      tasks_.pop_front();
      job_ = std::make_unique<JobContext>([this](std::string_view stage, double fraction) {
        {
          const std::scoped_lock inner(mutex_);
          state_.stage = stage;
          state_.fraction = fraction;
        }
        on_change_();
      });
      if (next.stopped || ended_) {
        job_->cancel();
      }
      state_.stage = "...";
      state_.fraction = 0;
    }
    on_change_();
    next.task();
    on_change_();
  }
  on_change_();
}

void MeshViewing::stop() {
  const std::scoped_lock lock(mutex_);
  std::erase_if(tasks_, [](const Waiting& one) { return !one.stays; });
  for (Waiting& one : tasks_) {
    one.stopped = true;
  }
  if (state_.section_due) {
    forget_section();
  }
  if (job_) {
    job_->cancel();
  }
}

void MeshViewing::complain(const Error& error) {
  if (error.kind != ErrorKind::kCancelled) {
    const std::scoped_lock lock(mutex_);
    state_.error = error;
  }
}

void MeshViewing::doubt_mesh(std::vector<Error> doubts) {
  const std::scoped_lock lock(mutex_);
  for (Error& doubt : doubts) {
    state_.mesh_doubts.push_back(std::move(doubt));
  }
}

void MeshViewing::take_mesh(std::shared_ptr<const Mesh> mesh, const RigidTransform& tablet_from_model,
                            const std::string& name) {
  analysis_.reset();
  analysis_options_ = {};
  wedges_file_.clear();
  unmeasured_.reset();
  foreign_wedges_.reset();
  {
    const std::scoped_lock lock(mutex_);
    state_.mesh = std::move(mesh);
    ++state_.number;
    state_.fields.clear();
    state_.wedges.reset();
    state_.doubts.clear();
    forget_section();
    state_.selections = std::make_shared<const std::vector<MeshSelection>>();
    state_.written.clear();
    state_.is_part = false;
    state_.corrections = 0;
    state_.not_made.clear();
    whole_.reset();
    selections_file_.clear();
    state_.tablet_from_model = tablet_from_model;
    state_.name = name;
    state_.mesh_doubts.clear();
    state_.error.reset();
    const std::size_t vertices = state_.mesh->positions.size();
    if (state_.mesh->sigma_mm.size() == vertices && vertices > 0) {
      state_.fields[MeshField::kSigma] = std::make_shared<const std::vector<float>>(state_.mesh->sigma_mm);
    }
  }
  on_change_();
}

void MeshViewing::take_field(MeshField field, std::vector<float> values) {
  const std::scoped_lock lock(mutex_);
  if (state_.mesh && values.size() == state_.mesh->positions.size()) {
    state_.fields[field] = std::make_shared<const std::vector<float>>(std::move(values));
  }
}

void MeshViewing::open(const fs::path& file) {
  ask([this, file] {
    const WedgesPlace wedges = wedges_beside(file);
    Result<MeshToView> read = read_mesh_to_view(file, wedges.file);
    if (!read) {
      complain(read.error());
      return;
    }
    const RigidTransform tablet_from_model = tablet_frame(read->mesh);
    label_ = std::move(read->label);
    unit_assumed_ = std::move(read->unit_assumed);
    take_mesh(std::make_shared<const Mesh>(std::move(read->mesh)), tablet_from_model,
              file.filename().string());
    unmeasured_ = std::move(read->unmeasured);
    doubt_mesh(std::move(read->doubts));
    if (wedges.unread) {
      complain(*wedges.unread);
    }
    take_selections(selections_file_of(file));
    take_corrections(wedges.file, wedges.in_session);
  });
}

void MeshViewing::show(std::shared_ptr<const Mesh> mesh, const RigidTransform& tablet_from_model,
                       const fs::path& wedges_file) {
  ask([this, mesh = std::move(mesh), tablet_from_model, wedges_file] {
    const bool known = is_known(mesh, wedges_file);
    if (!known) {
      take_mesh(mesh, tablet_from_model, {});
    }
    take_label_of_session(wedges_file.parent_path().parent_path());
    if (!known) {
      take_corrections(wedges_file, true);
    }
    take_selections(wedges_file.parent_path() / "selections.json");
  });
}

bool MeshViewing::is_known(const std::shared_ptr<const Mesh>& of_session, const fs::path& wedges_file) const {
  std::error_code error;
  if (!in_session_ || wedges_file_ != wedges_file || fs::exists(wedges_file, error)) {
    return false;
  }
  const Result<CorrectionFile> said = read_corrections(corrections_file_of(wedges_file));
  if (!said ||
      corrections_digest(said->corrections) != corrections_digest(analysis_options_.wedges.corrections)) {
    return false;
  }
  const std::scoped_lock lock(mutex_);
  return state_.mesh != nullptr && state_.mesh == of_session && !state_.is_part;
}

void MeshViewing::take_label_of_session(const fs::path& session) {
  label_ = {};
  unit_assumed_.clear();
  const Result<SessionStore> store = SessionStore::open(session, SessionStore::Access::kReadOnly);
  Result<FileLabel> label = store ? tablet_label(*store) : Result<FileLabel>(std::unexpected(store.error()));
  if (!label) {
    complain(label.error());
    return;
  }
  label_ = *std::move(label);
}

void MeshViewing::want(MeshField field) {
  ask(
      [this, field] {
        {
          const std::scoped_lock lock(mutex_);
          if (!state_.mesh || state_.fields.contains(field)) {
            return;
          }
        }
        work_out(field);
      },
      AskedBy::kWindow);
}

void MeshViewing::analyse() {
  ask([this] { work_out_everything(false); });
}

void MeshViewing::forget_section() {
  ++section_number_;
  state_.section.reset();
  state_.section_due = false;
}

void MeshViewing::cut(const Eigen::Vector3d& from_mm, const Eigen::Vector3d& to_mm,
                      const Eigen::Vector3d& towards) {
  std::uint64_t number = 0;
  {
    const std::scoped_lock lock(mutex_);
    forget_section();
    number = section_number_;
    state_.section_due = state_.mesh != nullptr && !ended_;
  }
  ask([this, number, from_mm, to_mm, towards] {
    std::shared_ptr<const Mesh> whole;
    {
      const std::scoped_lock lock(mutex_);
      if (number == section_number_) {  // else another was asked for, or another mesh is looked at
        whole = state_.mesh;
      }
    }
    if (!whole) {
      return;
    }
    Result<CrossSection> section = cross_section(*whole, from_mm, to_mm, towards);
    if (!section) {
      complain(section.error());
    }
    const std::scoped_lock lock(mutex_);
    if (number == section_number_) {
      state_.section_due = false;
      state_.section = section ? std::make_shared<const CrossSection>(*std::move(section)) : nullptr;
    }
  });
}

void MeshViewing::keep_section(const fs::path& stem) {
  std::shared_ptr<const CrossSection> section;  // that somebody saw who wants it kept
  {
    const std::scoped_lock lock(mutex_);
    section = state_.section;
  }
  if (!section) {
    return;
  }
  ask([this, stem, section] {
    std::vector<fs::path> files;
    for (const char* ending : {".csv", ".svg"}) {
      fs::path file = stem;
      file += ending;
      const Status outside = check_outside_packages(file);
      if (const Status written = outside ? write_section(*section, file, label_) : outside; !written) {
        complain(written.error());
        return;
      }
      files.push_back(std::move(file));
    }
    take_written(std::move(files));
  });
}

void MeshViewing::work_out(MeshField field) {
  const std::shared_ptr<const Mesh> shown = mesh();
  if (!shown || shown->faces.empty()) {
    return;
  }
  if (field == MeshField::kInvariant || field == MeshField::kHeight) {
    work_out_everything(field == MeshField::kInvariant);
    return;
  }
  const VertexGraph graph = make_vertex_graph(*shown);
  const VertexGeometry geometry = make_vertex_geometry(*shown, graph);
  job_->progress(field == MeshField::kOpenness ? "ambient occlusion" : "surface fields", 0.1);
  if (field == MeshField::kOpenness) {
    take_field(field, openness_of_bodies(*shown, geometry, {}, *job_));
  } else if (field == MeshField::kMeanCurvature) {
    take_field(field, vertex_curvature(*shown, graph, geometry).mean_per_mm);
  }
}

void MeshViewing::work_out_everything(bool with_invariant) {
  const std::shared_ptr<const Mesh> shown = mesh();
  if (!shown) {
    return;
  }
  if (!measure_all()) {
    return;
  }
  if (with_invariant) {
    job_->progress("integral invariants", 0.9);
    take_field(MeshField::kInvariant,
               strongest_response(invariants_of_bodies(*shown, analysis_->fields.body_of,
                                                       outlook_of(*shown, analysis_->fields),
                                                       analysis_->fields.mean_edge_mm, {}, *job_)));
  }
  take_measured_wedges();
  finish_corrections();
}

}  // namespace dubsar
