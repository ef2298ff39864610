// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/registrar.h"

#include <string>

#include "registration/point_pairs.h"
#include "registration/scan_model.h"

namespace dubsar {

struct Registrar::State : ScanModel {
  using ScanModel::ScanModel;
};

namespace {

/// Not put onto SO(3) once more: what is fixed stays as it was to the last digit.
RigidTransform as_fixed(const RigidTransform& pose) {
  return pose.is_rigid(1e-9) ? pose : pose.orthonormalised();
}

}  // namespace

Registrar::Registrar(const RegistrationOptions& options) : state_(std::make_unique<State>(options)) {}
Registrar::~Registrar() = default;
Registrar::Registrar(Registrar&&) noexcept = default;
Registrar& Registrar::operator=(Registrar&&) noexcept = default;

ScanPose Registrar::add(int id, const std::shared_ptr<const RangeGrid>& grid, const PinSet* pins,
                        JobContext& job) {
  if (state_->take_in(id, grid.get(), pins, false, job)) {
    state_->join(id, job);
    state_->retry(job);
  }
  state_->put_out_faulty(job);
  return state_->pose(id);
}

std::vector<ScanPose> Registrar::poses() const {
  return state_->poses();
}

bool Registrar::remove(int id, JobContext& job) {
  const bool freed = state_->free_hints_of(id);
  const bool there = state_->remove(id, job);
  if (freed) {
    state_->retry(job);
  }
  state_->settle_scale(job);
  state_->put_out_faulty(job);
  return there;
}

bool Registrar::set_pose(int id, const RigidTransform& model_from_scanner, bool locked, JobContext& job) {
  return model_from_scanner.is_rigid() &&
         state_->place(id, locked ? as_fixed(model_from_scanner) : model_from_scanner.orthonormalised(),
                       locked, job);
}

Status Registrar::set_hint(int id, const PoseHint& hint, JobContext& job) {
  const std::string where = "hint for scan " + std::to_string(id);
  if (hint.on < 0 || state_->stands_as(hint.on) == state_->stands_as(id)) {
    return fail(ErrorKind::kUsage, "a hint needs another scan", where, "name the scan that it lies on");
  }
  if (hint.on_from_scanner && !hint.on_from_scanner->is_rigid()) {
    return bad_input(where, "its pose is not a rigid transform", "give a turn and a shift, row by row");
  }
  if (!hint.on_from_scanner) {
    if (const Status good = check_point_pairs(hint.points, where); !good) {
      return good;
    }
  }
  if (const std::optional<int> locked = state_->locked_as(id)) {
    return fail(ErrorKind::kUsage,
                *locked == id ? "the scan is locked" : "scan " + std::to_string(*locked) + " is locked",
                where, "unlock it first");
  }
  const bool freed = state_->set_hint(id, hint);
  state_->follow_hint(id, job);
  if (freed) {
    state_->retry(job);
  }
  state_->put_out_faulty(job);
  return {};
}

void Registrar::clear_hint(int id, JobContext& job) {
  state_->clear_hint(id, job);
  state_->put_out_faulty(job);
}

bool Registrar::set_locked(int id, bool locked) {
  return state_->set_locked(id, locked);
}

LockOutcome Registrar::lock_near(int id, const RigidTransform& model_from_scanner) {
  return state_->lock_near(id, model_from_scanner);
}

ScanPose Registrar::add_at(int id, const std::shared_ptr<const RangeGrid>& grid, const PinSet* pins,
                           const RigidTransform& model_from_scanner, bool locked, JobContext& job) {
  const bool is_rigid = model_from_scanner.is_rigid();
  const bool is_sought = state_->take_in(id, grid.get(), pins, is_rigid && !locked, job);
  if (!is_rigid) {
    return state_->pose(id);
  }
  if (locked) {
    state_->place(id, as_fixed(model_from_scanner), true, job);
    return state_->pose(id);
  }
  if (is_sought) {
    state_->enter_at(id, model_from_scanner);
    state_->join(id, job);
    state_->retry(job);
  }
  state_->put_out_faulty(job);
  return state_->pose(id);
}

Status Registrar::finalize(JobContext& job) {
  return state_->finalize(job);
}

}  // namespace dubsar
