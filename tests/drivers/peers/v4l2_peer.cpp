// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// v4l2_peer FOLDER CARD MODE...: a camera as a file FOLDER/video0 that the kernel serves through FUSE, so
// that the driver's open, ioctl, poll and mmap are real system calls. MODE is e.g. GREY:640x480@200. Commands
// come on standard input, see VirtualCamera::command.
#define FUSE_USE_VERSION 35
#include <fuse3/fuse_lowlevel.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <set>
#include <thread>

#include "core/thread_priority.h"
#include "tests/drivers/peers/virtual_camera.h"

using dubsar::test::VirtualCamera;

namespace {

constexpr fuse_ino_t kNode = 2;

struct Peer {
  VirtualCamera camera;
  std::vector<std::uint8_t> memory;  ///< what is mapped, for pages that the kernel has not got yet
  fuse_session* session = nullptr;
  std::mutex polls_mutex;
  std::set<fuse_pollhandle*> polls;
  std::atomic<bool> quit = false;

  void wake() {
    std::set<fuse_pollhandle*> waiting;
    {
      const std::lock_guard lock(polls_mutex);
      waiting.swap(polls);
    }
    for (fuse_pollhandle* one : waiting) {
      fuse_lowlevel_notify_poll(one);
      fuse_pollhandle_destroy(one);
    }
  }
};

Peer* peer = nullptr;

void* who(const fuse_file_info* file) {
  return reinterpret_cast<void*>(file->fh);
}

struct stat attributes(fuse_ino_t node) {
  struct stat out {};
  out.st_ino = node;
  out.st_mode = node == FUSE_ROOT_ID ? S_IFDIR | 0755 : S_IFREG | 0666;
  out.st_size = node == FUSE_ROOT_ID ? 0 : static_cast<off_t>(peer->memory.size());
  return out;
}

void lookup(fuse_req_t request, fuse_ino_t parent, const char* name) {
  if (parent != FUSE_ROOT_ID || std::strcmp(name, "video0") != 0 || peer->camera.gone()) {
    fuse_reply_err(request, ENOENT);
    return;
  }
  fuse_entry_param entry{};
  entry.ino = kNode;
  entry.attr = attributes(kNode);
  entry.attr_timeout = 1e9;  // but the name is asked for each time: it may be unplugged
  fuse_reply_entry(request, &entry);
}

void getattr(fuse_req_t request, fuse_ino_t node, fuse_file_info* /*file*/) {
  const struct stat found = attributes(node);
  fuse_reply_attr(request, &found, 1e9);
}

void readdir(fuse_req_t request, fuse_ino_t node, std::size_t size, off_t offset, fuse_file_info* /*file*/) {
  char entry[256];
  if (node != FUSE_ROOT_ID || offset > 0 || peer->camera.gone()) {
    fuse_reply_buf(request, nullptr, 0);
    return;
  }
  const struct stat found = attributes(kNode);
  const std::size_t length = fuse_add_direntry(request, entry, sizeof entry, "video0", &found, 1);
  fuse_reply_buf(request, entry, std::min(size, length));
}

void open_node(fuse_req_t request, fuse_ino_t node, fuse_file_info* file) {
  auto* handle = new int(0);
  if (const int refused = node == kNode ? peer->camera.opened(handle) : -EISDIR; refused != 0) {
    delete handle;
    fuse_reply_err(request, -refused);
    return;
  }
  file->fh = reinterpret_cast<std::uint64_t>(handle);
  file->keep_cache = 1;
  fuse_reply_open(request, file);
}

void release(fuse_req_t request, fuse_ino_t /*node*/, fuse_file_info* file) {
  peer->camera.closed(who(file));
  delete static_cast<int*>(who(file));
  fuse_reply_err(request, 0);
}

void read_node(fuse_req_t request, fuse_ino_t /*node*/, std::size_t size, off_t offset,
               fuse_file_info* /*file*/) {
  const auto begin = std::min(static_cast<std::size_t>(offset), peer->memory.size());
  const std::size_t length = std::min(size, peer->memory.size() - begin);
  fuse_reply_buf(request, reinterpret_cast<const char*>(peer->memory.data() + begin), length);
}

void write_node(fuse_req_t request, fuse_ino_t /*node*/, const char* /*bytes*/, std::size_t size,
                off_t /*offset*/, fuse_file_info* /*file*/) {
  fuse_reply_write(request, size);
}

void ioctl_node(fuse_req_t request, fuse_ino_t /*node*/, unsigned command, void* /*argument*/,
                fuse_file_info* file, unsigned /*flags*/, const void* in, std::size_t in_size,
                std::size_t out_size) {
  std::vector<std::uint8_t> argument(std::max<std::size_t>(_IOC_SIZE(command), 8));
  const auto* from = static_cast<const std::uint8_t*>(in);  // null where the request carries nothing
  std::copy_n(from, std::min(in_size, argument.size()), argument.begin());
  const int answer = peer->camera.control(who(file), command, argument.data());
  if (answer < 0) {
    fuse_reply_err(request, answer == VirtualCamera::kNotYet ? EAGAIN : -answer);
  } else {
    fuse_reply_ioctl(request, 0, out_size > 0 ? argument.data() : nullptr, out_size);
  }
}

void poll_node(fuse_req_t request, fuse_ino_t /*node*/, fuse_file_info* file, fuse_pollhandle* handle) {
  if (handle != nullptr) {
    const std::lock_guard lock(peer->polls_mutex);
    peer->polls.insert(handle);
  }
  fuse_reply_poll(request, static_cast<unsigned>(peer->camera.poll_events(who(file))));
}

VirtualCamera::Mode mode_from(const char* text) {
  char name[5] = {};
  VirtualCamera::Mode mode{};
  if (std::sscanf(text, "%4[^:]:%ux%u@%u", name, &mode.width, &mode.height, &mode.rate_hz) != 4) {
    std::printf("cannot: no mode %s\n", text);
    std::exit(2);
  }
  for (int k = 3; k >= 0; --k) {
    mode.fourcc = mode.fourcc << 8U | static_cast<std::uint8_t>(name[k] == '\0' ? ' ' : name[k]);
  }
  return mode;
}

/// Each frame goes straight to the pages that the driver has mapped.
void run_camera() {
  dubsar::prefer_this_thread();
  const auto store = [](std::uint64_t offset, const std::vector<std::uint8_t>& frame) {
    std::ranges::copy(frame, peer->memory.begin() + static_cast<std::ptrdiff_t>(offset));
    fuse_bufvec bytes = FUSE_BUFVEC_INIT(frame.size());
    bytes.buf[0].mem = peer->memory.data() + offset;
    fuse_lowlevel_notify_store(peer->session, kNode, static_cast<off_t>(offset), &bytes,
                               static_cast<fuse_buf_copy_flags>(0));
  };
  while (!peer->quit) {
    if (peer->camera.tick(store)) {
      peer->wake();
    }
  }
}

void take_commands() {
  for (std::string line; std::getline(std::cin, line);) {
    const std::string answer = peer->camera.command(line);
    peer->wake();
    std::cout << answer << std::endl;
  }
  fuse_session_exit(peer->session);
}

}  // namespace

int main(int count, char** words) {
  if (count < 4) {
    std::puts("cannot: v4l2_peer FOLDER CARD MODE...");
    return 2;
  }
  std::vector<VirtualCamera::Mode> modes;
  for (int k = 3; k < count; ++k) {
    modes.push_back(mode_from(words[k]));
  }
  Peer here{.camera = VirtualCamera(words[2], modes), .memory = {}, .polls_mutex = {}, .polls = {}};
  here.memory.resize(here.camera.buffer_stride() * VirtualCamera::kMostBuffers);
  peer = &here;

  fuse_lowlevel_ops calls{};
  calls.lookup = lookup;
  calls.getattr = getattr;
  calls.readdir = readdir;
  calls.open = open_node;
  calls.release = release;
  calls.read = read_node;
  calls.write = write_node;
  calls.ioctl = ioctl_node;
  calls.poll = poll_node;
  const char* options[] = {"v4l2_peer", "-ofsname=v4l2_peer"};
  fuse_args arguments = FUSE_ARGS_INIT(2, const_cast<char**>(options));
  here.session = fuse_session_new(&arguments, &calls, sizeof calls, nullptr);
  if (here.session == nullptr || fuse_session_mount(here.session, words[1]) != 0) {
    std::puts("cannot: this machine lets nobody mount a FUSE file system");
    return 2;
  }
  std::puts("ready");
  std::fflush(stdout);
  std::thread camera(run_camera);
  std::thread commands([&] {
    take_commands();
    fuse_session_unmount(here.session);  // which ends the loop
  });
  dubsar::prefer_this_thread();  // it answers the system calls
  fuse_session_loop(here.session);
  here.quit = true;
  camera.join();
  commands.join();
  return 0;
}
