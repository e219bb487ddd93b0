/// @file Reads an endpoint without pause: several transfers wait for data at any time.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "drivers/usb/usb_device.h"

struct libusb_transfer;

namespace ca2 {

struct UsbReaderOptions {
  std::uint8_t endpoint = 0;
  bool interrupt = false;       ///< an interrupt endpoint; else bulk
  int transfers = 4;            ///< in flight at a time
  std::size_t buffer_size = 0;  ///< bytes; a multiple of the endpoint's packet size, so that none is too long
};

class UsbReader {
 public:
  /// `received` gets each completed transfer's bytes in order, `ended` once why no more will come (not after
  /// the destructor began). Both are called in the device's event thread and must not wait for transfers.
  UsbReader(UsbDevice& device, const UsbReaderOptions& options,
            std::function<void(std::span<const std::uint8_t>)> received,
            std::function<void(UsbOutcome)> ended);
  UsbReader(const UsbReader&) = delete;
  UsbReader& operator=(const UsbReader&) = delete;
  /// Cancels what is in flight and waits for it.
  ~UsbReader();

 private:
  struct Transfer {
    UsbReader* reader = nullptr;
    libusb_transfer* transfer = nullptr;
    std::vector<std::uint8_t> buffer;
    bool in_flight = false;
  };
  struct Completed;  ///< libusb's callback, whose type is libusb's

  void submit(Transfer& transfer);
  void complete(Transfer& transfer);
  void end(UsbOutcome outcome);

  std::function<void(std::span<const std::uint8_t>)> received_;
  std::function<void(UsbOutcome)> ended_;
  std::vector<std::unique_ptr<Transfer>> transfers_;
  std::mutex mutex_;  ///< guards what follows and Transfer::in_flight
  std::condition_variable idle_;
  int in_flight_ = 0;
  bool closing_ = false;
  bool over_ = false;  ///< `ended` was called
};

}  // namespace ca2
