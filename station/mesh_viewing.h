// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "analysis/cross_section.h"
#include "core/job.h"
#include "core/mesh.h"
#include "core/mesh_part.h"
#include "core/result.h"
#include "core/rigid_transform.h"
#include "core/wedge.h"
#include "core/wedge_correction.h"
#include "formats/file_label.h"
#include "station/analysis.h"

namespace dubsar {

/// Numbers that can be shown over a mesh.
enum class MeshField { kOpenness, kMeanCurvature, kHeight, kInvariant, kSigma };

/// A mesh that somebody looks at, with what is known of it so far. What is large is shared and never changed.
struct ViewedMesh {
  std::shared_ptr<const Mesh> mesh;
  std::uint64_t number = 0;  ///< grows whenever the mesh is another one
  std::map<MeshField, std::shared_ptr<const std::vector<float>>> fields;  ///< [V]
  std::shared_ptr<const std::vector<Wedge>> wedges;                       ///< null: none are known
  std::vector<Error> doubts;  ///< doubts_of() these wedges, of no place: it is the mesh that is looked at
  /// What measures wrongly as long as this mesh is looked at, whatever is done with it: its unit, its
  /// numbers, its faces; and wedges beside it that are not its own.
  std::vector<Error> mesh_doubts;
  std::shared_ptr<const CrossSection> section;  ///< the last that was asked for; else null
  bool section_due = false;                     ///< one is asked for and neither there nor given up
  std::shared_ptr<const std::vector<MeshSelection>> selections;  ///< that are kept; never null
  std::vector<std::filesystem::path> written;  ///< what was asked for last, once it is written
  bool is_part = false;                        ///< a part of a mesh that one can go back to
  std::size_t corrections = 0;                 ///< how many a person has made
  std::vector<std::string> not_made;           ///< why corrections could not be made
  RigidTransform tablet_from_model;
  std::string name;
  std::string stage;  ///< of the job that runs; empty: none does
  double fraction = 0;
  std::optional<Error> error;
};

/// Reads a mesh and finds out about it on a thread of its own, a job at a time in the order asked for.
class MeshViewing {
 public:
  explicit MeshViewing(std::function<void()> on_change);
  ~MeshViewing();
  MeshViewing(const MeshViewing&) = delete;
  MeshViewing& operator=(const MeshViewing&) = delete;

  [[nodiscard]] ViewedMesh state() const;
  /// Reads the mesh (read_mesh_to_view()), and the wedges beside it (wedges_beside()), unless they are those
  /// of_another_mesh(). No more: a field takes all cores, and who looks at a mesh wants to see it first.
  void open(const std::filesystem::path& file);
  /// Looks at the mesh of a session, which is there already: what is kept of it says what the session says of
  /// its tablet. Where it is looked at already, what was worked out of it stays, its wedges above all, which
  /// nobody writes before the session is stitched or exported.
  void show(std::shared_ptr<const Mesh> mesh, const RigidTransform& tablet_from_model,
            const std::filesystem::path& wedges_file);
  void want(MeshField field);  ///< works it out unless it is there
  /// All fields, and the wedges; an error where nobody knows the mesh's unit, as of all that rests on wedges.
  void analyse();
  /// Keeps a selection under its name, or under "NAME 2" and so on where that is another's; forgets one.
  void keep_selection(MeshSelection selection);
  void forget_selection(const std::string& name);
  /// Writes the selected part as a mesh of its own: a .ply, which holds all that is known of its vertices,
  /// and what is doubted of its unit.
  void write_part(MeshSelection selection, const std::filesystem::path& file);
  /// Writes the selected wedges as a table (CSV).
  void write_wedges_of(MeshSelection selection, const std::filesystem::path& file);
  /// Finds the wedges of the selected part alone: STEM.ply and STEM.wedges.json, then looks at that mesh.
  void analyse_part(MeshSelection selection, const std::filesystem::path& stem);
  /// Notes a correction of the wedges, whatever is stopped or closed then, and makes it; where it cannot be
  /// made, it is taken back and not_made says why; nor is it noted where another program has changed them
  /// since they were read, or where the file beside the mesh is another mesh's, which are errors. The wedges
  /// are measured first unless they were. Their file is written anew, that of a session when the session is
  /// stitched or exported next. What was stopped before that is made with the next one, or when the mesh is
  /// opened again.
  void correct(WedgeCorrection correction);
  void correct_by_adding(MeshSelection selection);  ///< a wedge is there
  void undo_correction();                           ///< the last one
  void leave_part();                                ///< looks at the mesh again that the part is of
  /// Cuts the mesh between two places of it, as it is seen from `towards` (model frame). The last cut is gone
  /// at once, also when this one has to wait, and whether or not it can be made.
  void cut(const Eigen::Vector3d& from_mm, const Eigen::Vector3d& to_mm, const Eigen::Vector3d& towards);
  /// Writes the cut that is there as STEM.csv and STEM.svg, which `written` says then; nothing where
  /// none is.
  void keep_section(const std::filesystem::path& stem);
  void stop();  ///< gives up what runs and what waits, but for noting what a person has said

 private:
  using Task = std::function<void()>;
  /// What a person asks for makes a refusal of before old; what the window wants by itself does not.
  /// What a person says is noted also when it is stopped while it waits.
  enum class AskedBy { kPerson, kPersonForGood, kWindow };
  struct Waiting {
    Task task;
    bool stays = false;    ///< also when what waits is given up
    bool stopped = false;  ///< and does no more than note it
  };
  void ask(Task task, AskedBy by = AskedBy::kPerson);
  void run();
  void take_mesh(std::shared_ptr<const Mesh> mesh, const RigidTransform& tablet_from_model,
                 const std::string& name);
  void take_label_of_session(const std::filesystem::path& session);
  /// It is looked at, and what is kept of its wedges is what is known of them here.
  [[nodiscard]] bool is_known(const std::shared_ptr<const Mesh>& of_session,
                              const std::filesystem::path& wedges_file) const;
  void take_selections(const std::filesystem::path& file);
  void take_corrections(const std::filesystem::path& wedges_file, bool in_session);
  void doubt_mesh(std::vector<Error> doubts);
  void make_corrections(std::vector<WedgeCorrection> corrections, bool must_make_last);
  [[nodiscard]] std::vector<WedgeCorrection> with_next(WedgeCorrection correction) const;
  [[nodiscard]] Status note(const std::vector<WedgeCorrection>& known,
                            const std::vector<WedgeCorrection>& now) const;
  [[nodiscard]] Status write_corrected();
  void finish_corrections();
  void say_corrected(std::vector<std::string> not_made);
  [[nodiscard]] bool measure_all();
  void take_written(std::vector<std::filesystem::path> files);
  void change_selections(const std::function<void(std::vector<MeshSelection>&)>& change);
  void take_field(MeshField field, std::vector<float> values);
  /// With what there is to doubt in them; `bodies` as doubts_of() has them.
  void take_wedges(WedgeFile found, std::size_t bodies = 0);
  void take_measured_wedges();
  void complain(const Error& error);
  void work_out(MeshField field);
  void work_out_everything(bool with_invariant);
  [[nodiscard]] std::shared_ptr<const Mesh> mesh() const;
  void forget_section();  ///< also one that is due; with the mutex held

  std::function<void()> on_change_;
  mutable std::mutex mutex_;  ///< of what follows
  ViewedMesh state_;
  // Of the worker alone.
  FileLabel label_;  ///< of the file that was opened, or of the session, for what is written of its mesh
  std::string unit_assumed_;            ///< of the file that was opened, for its wedges; never of a part
  std::unique_ptr<Analysis> analysis_;  ///< of the mesh, once it was asked for
  AnalysisOptions analysis_options_;
  std::filesystem::path wedges_file_;
  bool in_session_ = false;
  std::optional<Error> unmeasured_;      ///< why no wedges are measured of the mesh; never of a part
  std::optional<Error> foreign_wedges_;  ///< why those in wedges_file_ are not its own
  AnalysisOptions whole_options_;        ///< of the mesh that a part is of, like the next three
  std::filesystem::path whole_wedges_file_;
  bool whole_in_session_ = false;
  std::optional<Error> whole_foreign_wedges_;
  // Of whoever holds the mutex.
  std::uint64_t section_number_ = 0;  ///< of the cut that was asked for last
  std::filesystem::path selections_file_;
  std::optional<ViewedMesh> whole_;  ///< that a part is of, and where its selections are
  std::filesystem::path whole_selections_file_;
  std::deque<Waiting> tasks_;
  std::unique_ptr<JobContext> job_;
  bool running_ = false;
  bool ended_ = false;
  std::thread worker_;
};

}  // namespace dubsar
