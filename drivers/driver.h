/* SPDX-License-Identifier: Apache-2.0
 * Copyright The Dubsar developers */
#pragma once

/* The plugin interface between Dubsar and a device driver: plain C11, also valid C++. A driver is a shared
 * library with one exported function, dubsar_driver_entry(), and includes nothing of Dubsar but this file.
 *
 * Rules
 * - No C++ type and no exception crosses this interface.
 * - Every struct starts with struct_size (the driver itself with abi_version, then struct_size), set by
 * whoever makes the struct, or lends it to be filled, to the sizeof that he was compiled with. Structs grow
 * at their end only; nobody reads or writes a byte beyond struct_size.
 * - Lengths are mm, angles radians, frames right-handed, matrices 4 x 4, row by row, rigid, last row 0 0 0 1.
 * - Strings are UTF-8 and end with NUL; those that are handed to a callback live until it returns.
 * - Dubsar uses a device from one thread at a time; different devices may be used at once. All callbacks come
 * on the thread that made the call. A driver that captures with a thread of its own hands the profiles over
 *   through a queue of fixed size and counts what it had to drop.
 * - Functions return a dubsar_code; whenever it is none of DUBSAR_OK, DUBSAR_END and DUBSAR_TIMEOUT, the
 * error is filled.
 * - Nothing blocks for ever: a function that talks to a device gives up after 2 s without an answer (a move:
 * 2 s after the device last gave a sign of life; a homing, in which a firmware may be mute: 3 minutes).
 *
 * A driver serves any of three kinds of device, told by the flags of its capabilities: range sources
 * (scan()), cameras (start_frames() and its group) and stages (describe_axes() and its group). */

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Version 1 has grown at its end only: stop() came first, then frames and stages, then remark() of a
 * sink. A program or driver of before them still fits. */
#define DUBSAR_DRIVER_ABI_VERSION 1u

typedef enum dubsar_code {
  DUBSAR_OK = 0,
  DUBSAR_END = 1,       /* the source has no further scan */
  DUBSAR_USAGE = 2,     /* asked for something that does not exist */
  DUBSAR_BAD_INPUT = 3, /* outside bytes are not what they claim to be */
  DUBSAR_DEVICE = 4,    /* the device failed or is gone */
  DUBSAR_STORAGE = 5,   /* the disk refused */
  DUBSAR_CANCELLED = 6, /* a callback returned nonzero */
  DUBSAR_INTERNAL = 7,  /* a defect of the driver */
  DUBSAR_TIMEOUT = 8    /* of next_frame() alone: nothing came in the time that was given */
} dubsar_code;

/* What went wrong, where, and what to do about it: one line each, no trailing dot. */
typedef struct dubsar_error {
  uint32_t struct_size;
  int32_t code; /* dubsar_code */
  char what[256];
  char where[256];
  char mend[256];
} dubsar_error;

/* ---- Settings and options ---- */

typedef enum dubsar_type {
  DUBSAR_TYPE_BOOL = 0, /* integer, 0 or 1 */
  DUBSAR_TYPE_INTEGER = 1,
  DUBSAR_TYPE_NUMBER = 2,
  DUBSAR_TYPE_TEXT = 3,
  DUBSAR_TYPE_CHOICE = 4 /* text, one of choices */
} dubsar_type;

#define DUBSAR_SETTING_READABLE 1u
#define DUBSAR_SETTING_WRITABLE 2u

/* Describes an option of open() or a setting of an open device, so that a panel can build itself. */
typedef struct dubsar_setting {
  uint32_t struct_size;
  int32_t type;   /* dubsar_type */
  uint32_t flags; /* DUBSAR_SETTING_* */
  const char* key;
  const char* help;    /* one line for people */
  const char* unit;    /* "mm", "us", ...; NULL without one */
  const char* choices; /* words parted by '|'; NULL unless a choice */
  double minimum;      /* of a number or integer; no range when minimum > maximum */
  double maximum;
  double step; /* 0: any value */
} dubsar_setting;

typedef struct dubsar_value {
  uint32_t struct_size;
  int32_t type; /* dubsar_type */
  int64_t integer;
  double number;
  char text[256];
} dubsar_value;

typedef int32_t (*dubsar_setting_callback)(void* user, const dubsar_setting* setting);

/* One key=value of a device URI, percent-decoded. An array of these never grows its element. */
typedef struct dubsar_option {
  const char* key;
  const char* value;
} dubsar_option;

/* ---- Devices ---- */

typedef struct dubsar_device dubsar_device; /* the driver's own */

typedef struct dubsar_device_info {
  uint32_t struct_size;
  const char* uri; /* what opens it, e.g. "v4l2:/dev/video0" */
  const char* description;
} dubsar_device_info;

typedef int32_t (*dubsar_device_callback)(void* user, const dubsar_device_info* info);

#define DUBSAR_VIEW_LASER 1u  /* laser_mm is known */
#define DUBSAR_VIEW_CAMERA 2u /* camera_mm is known */

/* Embedded in other structs, so it never grows. Where the scanner looks from, in the scanner frame. A linear
 * scanner moves by motion_per_row_mm between profiles; laser and camera are where they are at row 0. Without
 * positions, direction stands in. */
typedef struct dubsar_view {
  uint32_t struct_size;
  uint32_t flags;      /* DUBSAR_VIEW_* */
  double direction[3]; /* unit, from the scanner to the object */
  double laser_mm[3];
  double camera_mm[3];
  double motion_per_row_mm[3];
} dubsar_view;

#define DUBSAR_HAS_TURNTABLE 1u  /* a full turn about stage z, by motor */
#define DUBSAR_HAS_TILT 2u       /* tilt of the scanner's axis from the vertical, by motor */
#define DUBSAR_HAS_HAND_TURNS 4u /* the tablet can be laid on another side, by hand or in simulation */
#define DUBSAR_IS_FINITE 8u      /* plays what was recorded: scan() ends with DUBSAR_END */
#define DUBSAR_HAS_RIG 16u       /* the geometry below is that of the device; else it is not known */
#define DUBSAR_HAS_ARM 32u  /* an arm carries the scanner anywhere: arm_* below, placements have a pose */
#define DUBSAR_HAS_HEAD 64u /* head_* is the body of the scanner */
#define DUBSAR_HAS_TURN_LIMITS 128u  /* turntable_min_rad and turntable_max_rad are its ends */
#define DUBSAR_YIELDS_FRAMES 256u    /* a camera: the group of start_frames() works */
#define DUBSAR_IS_STAGE 512u         /* motion and laser: the group of describe_axes() works */
#define DUBSAR_YIELDS_NO_SCANS 1024u /* scan() answers DUBSAR_USAGE: it takes a rig to make scans of this */

/* What a device can do, and its geometry. The stage frame has its origin at the turntable's centre on the
 * support, z up. The scanner frame: origin in the centre of the measuring volume, x along a profile, y
 * along the motion, z towards the scanner. */
typedef struct dubsar_capabilities {
  uint32_t struct_size;
  uint32_t flags;     /* DUBSAR_HAS_*, DUBSAR_IS_* */
  int64_t scan_count; /* of a finite source; -1 when not known before it has been read */
  double tilt_min_rad;
  double tilt_max_rad;
  double spacing_mm;
  double field_x_mm;
  double field_y_mm;
  double depth_range_mm;
  double support_height_mm;    /* nothing below this stage height can be seen */
  double calibration_age_days; /* negative when not known */
  dubsar_view view;
  char name[128];
  char calibration[256];    /* what it was calibrated with; empty when not known */
  double turntable_min_rad; /* with DUBSAR_HAS_TURN_LIMITS */
  double turntable_max_rad;
  /* With DUBSAR_HAS_HEAD: a box in the scanner frame that holds the scanner's body from the first row of a
   * scan to the last. Without it Dubsar takes a box around laser and camera. */
  double head_low_mm[3];
  double head_high_mm[3];
  /* With DUBSAR_HAS_ARM: where the middle of the head's box can be. Its axis tilts from tilt_min_rad to
   * tilt_max_rad, which then need no DUBSAR_HAS_TILT. */
  double arm_base_mm[3];     /* the arm's foot, stage frame */
  double arm_reach_mm[2];    /* from there, least and most */
  double arm_height_mm[2];   /* above the support */
  double arm_standoff_mm[2]; /* from the origin of the stage */
  char serial[64];           /* of this one device, to tell it from its like; empty when not known */
  char model[128];           /* maker and model; empty when not known */
} dubsar_capabilities;

/* Where the next scan is to be taken from. */
typedef struct dubsar_placement {
  uint32_t struct_size;
  uint32_t has_hand_turn; /* nonzero: the tablet was turned by hand for it; see place() */
  double turntable_rad;
  double tilt_rad;
  /* The turn that is asked for, tablet_new_from_tablet_old in the stage frame, about the tablet's centre. The
   * translation is where the centre then lies, from the stage's origin along the support, and along z how far
   * above the middle of the scanner's depth (below it: less than 0); 0, 0, 0 but for tablets that are larger
   * than the field or reach beyond the depth. */
  double hand_turn[16];
  /* Of a device with an arm, when nonzero: drive to stage_from_scanner; turntable and tilt are 0. Zero: the
   * arm stays. The stage stands still under an arm. */
  uint32_t has_free_pose;
  uint32_t reserved;
  double stage_from_scanner[16];
} dubsar_placement;

/* ---- A scan, profile by profile ---- */

#define DUBSAR_SCAN_UNORDERED 1u /* points without rows and columns; profiles are mere chunks */
#define DUBSAR_SCAN_NOMINAL 2u   /* the nominal pose is known */

typedef struct dubsar_scan_info {
  uint32_t struct_size;
  uint32_t flags;        /* DUBSAR_SCAN_* */
  int32_t cols;          /* samples per profile; 0 when unordered */
  int32_t expected_rows; /* 0 when not known */
  double spacing_mm;     /* nominal lateral spacing; 0 when not known */
  dubsar_view view;
  /* The pose that the motors (and the asked-for hand turn) say, with standard deviations. Scans of one
   * placement number were taken without lifting the tablet and agree to sigma_*; between placements they
   * agree to hand_sigma_* only. The translation is in numbers 3, 7 and 11; another layout is refused. */
  double tablet_from_scanner[16];
  int32_t placement;
  int32_t reserved;
  double sigma_mm;
  double sigma_rad;
  double hand_sigma_mm;
  double hand_sigma_rad;
  double pin_tip_diameter_mm; /* > 0 when fiducial pins stand in the scene */
  int64_t timestamp_ns;       /* since 1970; 0 when not known */
  const char* device_id;      /* of this one device, e.g. with its serial number; NULL when not known */
  const char* source;         /* the scan's original name; NULL without one */
  const char* file;           /* that a recorded scan is read from, with its folders; NULL without one */
} dubsar_scan_info;

/* One row of the scan. Arrays are as long as count (rgb: three times) and live until the callback returns. */
typedef struct dubsar_profile {
  uint32_t struct_size;
  uint32_t count; /* = cols unless unordered */
  int64_t row;    /* ascending; a gap means rows that were lost */
  const float* x; /* scanner frame, mm */
  const float* y;
  const float* z;
  const uint8_t* valid;    /* 0 where there was no return; NULL: all returned */
  const float* intensity;  /* in [0,1], or NULL */
  const float* confidence; /* in [0,1], or NULL */
  const uint8_t* rgb;      /* or NULL */
  const float* normals;    /* 3 * count, unit, of unordered points; or NULL */
  int64_t timestamp_ns;    /* 0 when not known */
  uint32_t flags;          /* DUBSAR_PROFILE_* */
  uint32_t reserved;
  int64_t encoder; /* with DUBSAR_PROFILE_ENCODER: counts of the motion encoder when it was taken */
} dubsar_profile;

#define DUBSAR_PROFILE_ENCODER 1u

typedef struct dubsar_scan_end {
  uint32_t struct_size;
  int32_t code;              /* dubsar_code: how the scan ended */
  uint64_t profiles_sent;    /* to this sink */
  uint64_t profiles_dropped; /* lost because nobody took them in time */
  uint64_t frames_repeated;  /* came twice and were left out */
} dubsar_scan_end;

/* Where a scan goes: begin once, profile per row, end once whatever happened after begin. A callback that
 * returns nonzero cancels: the driver stops its motion, calls end, and returns DUBSAR_CANCELLED. */
typedef struct dubsar_sink {
  uint32_t struct_size;
  uint32_t reserved;
  void* user;
  int32_t (*begin)(void* user, const dubsar_scan_info* info);
  int32_t (*profile)(void* user, const dubsar_profile* profile);
  void (*end)(void* user, const dubsar_scan_end* end);
  /* NULL, or beyond struct_size, in a program that takes none: the driver then tells its log. Between begin
   * and end: what the operator should know of this scan and what stops nothing, in one line. */
  void (*remark)(void* user, const char* text);
} dubsar_sink;

/* ---- Frames of a camera ---- */

/* Pixel formats by their GenICam (PFNC) numbers. A driver delivers these and no others, unpacked, in the byte
 * order of this machine; what a camera sends otherwise it unpacks or converts on the thread that calls
 * next_frame(), never on one that captures. Mono10 to Mono16 take two bytes, the value in the low bits. */
typedef enum dubsar_pixel_format {
  DUBSAR_PIXEL_MONO8 = 0x01080001,
  DUBSAR_PIXEL_MONO10 = 0x01100003,
  DUBSAR_PIXEL_MONO12 = 0x01100005,
  DUBSAR_PIXEL_MONO14 = 0x01100025,
  DUBSAR_PIXEL_MONO16 = 0x01100007
} dubsar_pixel_format;

#define DUBSAR_FRAME_INCOMPLETE 1u /* a part of the pixels never came */
#define DUBSAR_FRAME_ENCODER 2u    /* encoder is known */
#define DUBSAR_FRAME_EXPOSED 4u    /* timestamp_ns is of the exposure; else of the arrival */
#define DUBSAR_FRAME_LATE 8u       /* waited longer than a frame takes before it was fetched */

/* One frame, lent by a driver from its pool. The pixels stay until release_frame(lease), also behind
 * stop_frames() and when the device is gone; close() ends all leases. */
typedef struct dubsar_frame {
  uint32_t struct_size;
  uint32_t flags; /* DUBSAR_FRAME_* */
  uint64_t lease;
  uint64_t id;                 /* ascending from start_frames() on; a gap is frames that were lost */
  int64_t timestamp_ns;        /* on this machine's CLOCK_MONOTONIC */
  int64_t device_timestamp_ns; /* on the device's own clock; 0 when it has none */
  int64_t encoder;
  const uint8_t* pixels; /* row 0 first */
  uint64_t size_bytes;
  uint32_t width;
  uint32_t height;
  uint32_t stride_bytes;
  uint32_t pixel_format; /* dubsar_pixel_format */
  uint32_t offset_x;     /* of the region on the sensor, pixels */
  uint32_t offset_y;
} dubsar_frame;

/* Since open(), so that replugging hides nothing. */
typedef struct dubsar_frame_counters {
  uint32_t struct_size;
  uint32_t pool;          /* buffers that there are */
  uint64_t delivered;     /* frames handed out */
  uint64_t lost;          /* gaps in the ids: lost on the way, or for want of a free buffer */
  uint64_t late;          /* of those delivered: marked DUBSAR_FRAME_LATE */
  uint64_t incomplete;    /* of those delivered: marked DUBSAR_FRAME_INCOMPLETE */
  uint64_t resent;        /* packets that were asked for again and came */
  uint64_t reconnections; /* times that the device was found again after it was gone */
  uint64_t starved;       /* of those lost: for want of a free buffer, as far as the driver can tell */
} dubsar_frame_counters;

/* ---- Axes and lasers of a stage ---- */

#define DUBSAR_AXES_MAX 8
#define DUBSAR_LASERS_MAX 8

typedef enum dubsar_axis_kind {
  DUBSAR_AXIS_LINEAR = 0, /* positions in mm, speeds in mm/s */
  DUBSAR_AXIS_ROTARY = 1  /* positions in rad, speeds in rad/s */
} dubsar_axis_kind;

#define DUBSAR_AXIS_CAN_HOME 1u /* has a reference switch; positions mean nothing before home() */
#define DUBSAR_AXIS_ENDLESS 2u  /* goes round and round: minimum and maximum are not its ends */

typedef struct dubsar_axis {
  uint32_t struct_size;
  uint32_t flags; /* DUBSAR_AXIS_* */
  int32_t kind;   /* dubsar_axis_kind */
  int32_t reserved;
  const char* name;
  double minimum; /* soft limits, which move() keeps */
  double maximum;
  double speed_maximum;
  double resolution; /* one step of the motor */
} dubsar_axis;

typedef int32_t (*dubsar_axis_callback)(void* user, const dubsar_axis* axis);

#define DUBSAR_MOVE_START_ONLY 1u /* return once it moves; else when it stands still at the target */

typedef struct dubsar_move {
  uint32_t struct_size;
  uint32_t flags; /* DUBSAR_MOVE_* */
  uint32_t axis;  /* in the order of describe_axes() */
  uint32_t reserved;
  double position; /* absolute; mm or rad */
  double speed;    /* mm/s or rad/s; 0: as the setting `speed` says */
} dubsar_move;

#define DUBSAR_MOTION_MOVING 1u
#define DUBSAR_MOTION_ALARM 2u /* the firmware refuses to move until home() */
#define DUBSAR_MOTION_HOMED 4u /* positions are those of the machine */
#define DUBSAR_MOTION_COMMANDED \
  8u /* positions are what was asked for: the firmware does not report its own */

/* Where a stage is. The positions held at timestamp_ns to within uncertainty_ns, half of the time between
 * question and answer. */
typedef struct dubsar_motion {
  uint32_t struct_size;
  uint32_t flags;       /* DUBSAR_MOTION_* */
  int64_t timestamp_ns; /* on this machine's CLOCK_MONOTONIC */
  int64_t uncertainty_ns;
  uint32_t axis_count;
  uint32_t laser_count;
  double position[DUBSAR_AXES_MAX];
  double laser[DUBSAR_LASERS_MAX]; /* power as last set, 0 to 1 */
} dubsar_motion;

/* ---- The driver ---- */

/* All pointers are set unless marked optional. Pointers stay good until the program ends. */
typedef struct dubsar_driver {
  uint32_t abi_version; /* DUBSAR_DRIVER_ABI_VERSION */
  uint32_t struct_size;
  const char* scheme;       /* of its URIs: a lower-case letter, then a-z, 0-9, '_' */
  const char* description;  /* one line */
  const char* version;      /* of the driver */
  const char* locator_help; /* what stands between the colon and '?', for people; empty when nothing does */

  /* Calls back for each option that open() knows. */
  int32_t (*describe_options)(dubsar_setting_callback callback, void* user, dubsar_error* error);
  /* Calls back for each device that is there; finding none is no error. Takes seconds at most. */
  int32_t (*discover)(dubsar_device_callback callback, void* user, dubsar_error* error);
  int32_t (*open)(const char* locator, const dubsar_option* options, uint32_t option_count,
                  dubsar_device** device, dubsar_error* error);
  void (*close)(dubsar_device* device);
  int32_t (*capabilities)(dubsar_device* device, dubsar_capabilities* capabilities, dubsar_error* error);

  /* Optional, all three or none: settings of an open device. */
  int32_t (*describe_settings)(dubsar_device* device, dubsar_setting_callback callback, void* user,
                               dubsar_error* error);
  int32_t (*get_setting)(dubsar_device* device, const char* key, dubsar_value* value, dubsar_error* error);
  int32_t (*set_setting)(dubsar_device* device, const char* key, const dubsar_value* value,
                         dubsar_error* error);

  /* Optional: drives to (or simulates) a placement. Returns when the device stands still. After open() a
   * device with turntable or tilt stands at 0 or as near to 0 as its limits let it. An arm goes straight from
   * where it stands: the origin of the scanner frame along a line, the turn by the shorter way at the same
   * time; Dubsar sends the stops in between that keep it clear of the tablet. The first placement may start
   * anywhere, and is the driver's to make safe. A driver refuses what lies outside its limits, or where its
   * head would touch the support or the tablet as far as it knows them, with DUBSAR_USAGE before it moves.
   * A placement with a hand turn is asked for only after the operator has said that the tablet lies so and
   * that no hand is near: place() waits for nobody, and drives at once. The scheme "sim" alone is asked
   * without that word, as it turns a tablet that nobody's hands are at. */
  int32_t (*place)(dubsar_device* device, const dubsar_placement* placement, dubsar_error* error);
  /* Runs the next scan into the sink, from begin to end. DUBSAR_END, with no callback made, when a finite
   * source has played its last. After a bad scan of a finite source, the next call goes on with the one
   * behind. */
  int32_t (*scan)(dubsar_device* device, const dubsar_sink* sink, dubsar_error* error);

  /* Optional: stops all motion at once. The one function that may be called from another thread while place()
   * or scan() of the same device runs, which then return soon with DUBSAR_CANCELLED. Called when the operator
   * cancels and after every failed place() or scan(); stopping what stands still is no error. The next
   * place() moves again. */
  int32_t (*stop)(dubsar_device* device, dubsar_error* error);

  /* Optional, all five or none: the frames of a camera. start_frames() takes a pool of so many buffers (0: as
   * the driver likes) and starts the stream; after the device was gone it looks for it again and goes on
   * where it is back. next_frame() lends the next frame, DUBSAR_TIMEOUT where none came within timeout_ms; a
   * device that is gone is DUBSAR_DEVICE within 2 s. release_frame() gives a frame back, in any order and
   * from any thread. Where the caller holds all buffers the device loses frames, which is counted.
   * stop_frames() on what stands still is no error. frame_counters() may be called from any thread. */
  int32_t (*start_frames)(dubsar_device* device, uint32_t pool, dubsar_error* error);
  int32_t (*next_frame)(dubsar_device* device, uint32_t timeout_ms, dubsar_frame* frame, dubsar_error* error);
  void (*release_frame)(dubsar_device* device, uint64_t lease);
  int32_t (*stop_frames)(dubsar_device* device, dubsar_error* error);
  int32_t (*frame_counters)(dubsar_device* device, dubsar_frame_counters* counters, dubsar_error* error);
  /* Optional: releases one frame of a camera whose setting `trigger` is `software`. */
  int32_t (*trigger_frame)(dubsar_device* device, dubsar_error* error);

  /* Optional, all six or none: a stage. move() refuses what lies outside the soft limits with DUBSAR_USAGE
   * before anything moves; home() drives to the reference switches. set_laser() takes a power from 0 to 1.
   * read_motion() and set_laser() may be called while a move that was started runs; stop() and
   * emergency_stop() from another thread at any time, also while home() or move() runs there, which then
   * return soon with DUBSAR_CANCELLED. stop() ends the motion and leaves the position known.
   * emergency_stop() ends it as fast as can be, lasers off; afterwards nothing moves until home() (without
   * switches: until the device is opened anew). OK of either says that the device obeyed or had nothing to
   * end. The lasers are off after open(), after stop(), close() and any error of the device, and the driver
   * sees to it that they go off when the program dies. */
  int32_t (*describe_axes)(dubsar_device* device, dubsar_axis_callback callback, void* user,
                           dubsar_error* error);
  int32_t (*home)(dubsar_device* device, dubsar_error* error);
  int32_t (*move)(dubsar_device* device, const dubsar_move* move, dubsar_error* error);
  int32_t (*read_motion)(dubsar_device* device, dubsar_motion* motion, dubsar_error* error);
  int32_t (*set_laser)(dubsar_device* device, uint32_t laser, double power, dubsar_error* error);
  int32_t (*emergency_stop)(dubsar_device* device, dubsar_error* error);
} dubsar_driver;

#if defined(_WIN32)
#define DUBSAR_DRIVER_EXPORT __declspec(dllexport)
#else
#define DUBSAR_DRIVER_EXPORT __attribute__((visibility("default")))
#endif

#define DUBSAR_DRIVER_ENTRY "dubsar_driver_entry"

/* The one symbol of a plugin. The answer is the same at every call. */
DUBSAR_DRIVER_EXPORT const dubsar_driver* dubsar_driver_entry(void);

#ifdef __cplusplus
}
#endif
