// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "drivers/aravis/camera_clock.h"
#include "drivers/aravis/encoder_count.h"
#include "drivers/aravis/frame_count.h"
#include "drivers/aravis/presence.h"
#include "drivers/aravis/scan3d.h"
#include "drivers/driver.h"

// NOLINTBEGIN(bugprone-reserved-identifier): the names that Aravis gave its structures
typedef struct _ArvCamera ArvCamera;
typedef struct _ArvDevice ArvDevice;
typedef struct _ArvStream ArvStream;
typedef struct _ArvBuffer ArvBuffer;
typedef struct _ArvChunkParser ArvChunkParser;
// NOLINTEND(bugprone-reserved-identifier)

namespace dubsar::aravis {

using Clock = std::chrono::steady_clock;

struct CameraOptions {
  std::string format;              ///< a PFNC name; empty: the best that there is
  std::uint32_t buffers = 0;       ///< 0: as many as half a second takes, see pool_depth()
  std::uint32_t packet_bytes = 0;  ///< of GigE Vision; 0: what the way carries
  bool resend = true;
  bool packet_socket = true;
  // Of range cameras:
  std::int64_t rows = 1000;  ///< profiles in a scan
  double row_mm = 0;         ///< motion from row to row; 0: the camera's own scale of B
  double encoder_mm = 0;     ///< per count of the encoder; 0: rows are evenly spaced
  bool flip_z = false;
  double wait_s = 1.5;  ///< for the next profiles
};

/// A frame as it came; give it back by its lease.
struct Taken {
  std::uint64_t lease = 0;
  const std::uint8_t* pixels = nullptr;
  std::size_t size = 0;
  std::uint32_t width = 0, height = 0, offset_x = 0, offset_y = 0;
  std::uint64_t id = 0;    ///< ascending from the start of the stream, wrapping undone
  std::uint64_t lost = 0;  ///< frames that did not come before this one
  std::int64_t timestamp_ns = 0;
  std::int64_t device_timestamp_ns = 0;
  std::optional<std::int64_t> encoder;  ///< likewise
  bool camera_restarted = false;        ///< the first since: its counts begin elsewhere
  bool late = false;                    ///< waited longer than a frame takes
};

/// A GigE Vision or USB3 Vision camera from open to close, plugged in or not. The stream's own thread puts
/// packets together and does nothing else.
class Camera {
 public:
  /// kDevice: not there, in use, no right; kBadInput: its description cannot be read or says what cannot be.
  [[nodiscard]] static Result<std::unique_ptr<Camera>> open(const std::string& id,
                                                            const CameraOptions& options);
  ~Camera();
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;

  [[nodiscard]] const std::string& id() const { return id_; }
  [[nodiscard]] const std::string& model() const { return model_; }
  [[nodiscard]] const std::string& serial() const { return serial_; }
  [[nodiscard]] const CameraOptions& options() const { return options_; }
  /// Of a range camera.
  [[nodiscard]] const RangeFormat* range() const { return range_; }
  [[nodiscard]] std::uint32_t pixel_format() const { return pixel_format_; }
  [[nodiscard]] Result<Scan3d> scan3d();

  struct Feature {
    std::string key, help, unit, name;  ///< name: of the camera's feature
    dubsar_type type = DUBSAR_TYPE_NUMBER;
    double minimum = 1, maximum = 0;
    std::string choices = {};
    bool writable = true;
  };
  [[nodiscard]] std::vector<Feature> features();
  [[nodiscard]] Result<dubsar_value> get(const Feature& feature);
  Status set(const Feature& feature, const dubsar_value& value);

  Status start(std::uint32_t pool);
  /// Nothing when none came in time; kDevice within 2 s when the camera is gone. One that is there and has
  /// let go of this program (its heartbeat was missed, it started anew) is taken anew on the way, and goes on
  /// with its settings; what it would have sent meanwhile is lost, counted at the rate of the frames before.
  [[nodiscard]] Result<std::optional<Taken>> next(Clock::time_point until);
  /// True when its silence has a reason that next() comes to before long: it has not answered of late and may
  /// be gone, or it obeys this program no more and is taken anew. Asks it.
  [[nodiscard]] bool is_doubtful();
  /// What is not lent is passed over.
  void give_back(std::uint64_t lease);
  /// kDevice: it may go on, its laser too. What this leaves is no stream in any case.
  Status stop();
  /// What stop() said last, kDevice too where the camera was lost with its stream running; OK while one runs.
  /// From any thread.
  [[nodiscard]] Status ended();
  Status trigger();
  /// From any thread; as counters of the interface; none is incomplete.
  [[nodiscard]] dubsar_frame_counters counters();

 private:
  Camera() = default;
  Status connect();
  /// The stream; connects first where it has to. What breaks a connection leaves none.
  Status begin(std::uint32_t pool);
  [[nodiscard]] bool has_control() const;
  /// Whether it says that it obeys nobody, which Aravis asks once a second.
  [[nodiscard]] bool has_let_go();
  /// Whether the camera obeys this program, after a second's patience.
  [[nodiscard]] bool take_control();
  Status configure();
  Status choose_format();
  /// What Aravis holds of a camera.
  struct Connection {
    ArvStream* stream = nullptr;
    ArvChunkParser* chunks = nullptr;
    ArvCamera* camera = nullptr;
  };
  /// Leaves this without a connection. What is let go of is to be released; that takes seconds where the
  /// camera is gone, and tells one that is there to end its stream.
  [[nodiscard]] Connection let_go();
  static void release(const Connection& old);
  void lose();
  /// Ends in a stream that runs, or without a camera (retake.cpp).
  Status retake();
  /// Goes on with the connection and the stream of another, which is left with none.
  void adopt(Camera& fresh);
  /// Once, when the kernel keeps too few of its packets.
  void say_room(std::uint64_t payload);
  [[nodiscard]] std::unexpected<Error> gone() const;
  void add_statistics(dubsar_frame_counters& to) const;

  std::string id_, model_, serial_;
  CameraOptions options_;
  ArvCamera* camera_ = nullptr;  ///< none while it is gone
  ArvDevice* device_ = nullptr;
  std::unique_ptr<Presence> presence_;
  const RangeFormat* range_ = nullptr;
  std::uint32_t pixel_format_ = 0;
  std::uint32_t bytes_per_pixel_ = 1;
  std::map<std::string, dubsar_value> set_here_;  ///< set again over a new connection
  std::shared_ptr<std::atomic<bool>> control_lost_;

  mutable std::mutex mutex_;  ///< of what give_back(), counters() and ended() look at
  ArvStream* stream_ = nullptr;
  ArvChunkParser* chunks_ = nullptr;
  bool has_encoder_chunk_ = false;
  std::uint64_t last_lease_ = 0;
  std::map<std::uint64_t, ArvBuffer*> lent_;   ///< by their leases
  std::map<std::uint64_t, ArvBuffer*> stale_;  ///< lent by a stream that is no more
  std::uint64_t payload_ = 0;                  ///< bytes of a buffer
  Status ended_;
  FrameCount count_;
  EncoderCount encoder_;
  CameraClock clock_{std::nullopt};
  dubsar_frame_counters counts_{};
  bool said_room_ = false;
};

struct FoundCamera {
  std::string id, description;
};
/// Takes about a second: cameras are asked over all networks.
[[nodiscard]] std::vector<FoundCamera> find_cameras();

}  // namespace dubsar::aravis
