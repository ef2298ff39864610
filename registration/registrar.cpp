// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/registrar.h"

#include "registration/scan_model.h"

namespace dubsar {

struct Registrar::State : ScanModel {
  using ScanModel::ScanModel;
};

Registrar::Registrar(RegistrationOptions options) : state_(std::make_unique<State>(std::move(options))) {}
Registrar::~Registrar() = default;
Registrar::Registrar(Registrar&&) noexcept = default;
Registrar& Registrar::operator=(Registrar&&) noexcept = default;

ScanPose Registrar::add(int id, const std::shared_ptr<const RangeGrid>& grid, const PinSet* pins,
                        JobContext& job) {
  state_->remove(id);
  state_->enter(id, grid.get(), pins);
  if (state_->join(id, job)) {
    state_->retry(job);
  }
  return state_->pose(id);
}

std::vector<ScanPose> Registrar::poses() const {
  return state_->poses();
}

bool Registrar::remove(int id) {
  return state_->remove(id);
}

bool Registrar::set_pose(int id, const RigidTransform& model_from_scanner, bool locked) {
  return model_from_scanner.is_rigid() && state_->place(id, model_from_scanner.orthonormalised(), locked);
}

Status Registrar::finalize(JobContext& job) {
  return state_->finalize(job);
}

}  // namespace dubsar
