#include "drivers/usb/usb_reader.h"

#include <libusb-1.0/libusb.h>

namespace ca2 {
namespace {

UsbOutcome outcome_of(libusb_transfer_status status) {
  switch (status) {
    case LIBUSB_TRANSFER_COMPLETED:
      return UsbOutcome::done;
    case LIBUSB_TRANSFER_TIMED_OUT:
      return UsbOutcome::timeout;
    case LIBUSB_TRANSFER_NO_DEVICE:
      return UsbOutcome::gone;
    case LIBUSB_TRANSFER_STALL:
      return UsbOutcome::stalled;
    case LIBUSB_TRANSFER_OVERFLOW:
      return UsbOutcome::overflow;
    default:
      return UsbOutcome::failed;
  }
}

}  // namespace

struct UsbReader::Completed {
  static void LIBUSB_CALL call(libusb_transfer* transfer) {
    auto& mine = *static_cast<Transfer*>(transfer->user_data);
    mine.reader->complete(mine);
  }
};

UsbReader::UsbReader(UsbDevice& device, const UsbReaderOptions& options,
                     std::function<void(std::span<const std::uint8_t>)> received,
                     std::function<void(UsbOutcome)> ended)
    : received_(std::move(received)), ended_(std::move(ended)) {
  for (int i = 0; i < options.transfers; ++i) {
    auto transfer = std::make_unique<Transfer>();
    transfer->reader = this;
    transfer->buffer.resize(options.buffer_size);
    transfer->transfer = libusb_alloc_transfer(0);
    // No time limit: a device that is silent is its user's to judge.
    const auto fill = options.interrupt ? libusb_fill_interrupt_transfer : libusb_fill_bulk_transfer;
    fill(transfer->transfer, device.handle(), options.endpoint, transfer->buffer.data(),
         static_cast<int>(transfer->buffer.size()), Completed::call, transfer.get(), 0);
    transfers_.push_back(std::move(transfer));
  }
  for (const auto& transfer : transfers_) submit(*transfer);
}

UsbReader::~UsbReader() {
  std::unique_lock lock(mutex_);
  closing_ = true;
  for (const auto& transfer : transfers_) {
    if (transfer->in_flight) libusb_cancel_transfer(transfer->transfer);
  }
  idle_.wait(lock, [&] { return in_flight_ == 0; });
  for (const auto& transfer : transfers_) libusb_free_transfer(transfer->transfer);
}

void UsbReader::submit(Transfer& transfer) {
  int code = 0;
  {
    const std::lock_guard lock(mutex_);
    if (closing_ || over_) return;
    code = libusb_submit_transfer(transfer.transfer);
    if (code >= 0) {
      transfer.in_flight = true;
      ++in_flight_;
      return;
    }
  }
  end(usb_outcome(code));
}

void UsbReader::complete(Transfer& transfer) {
  const UsbOutcome outcome = outcome_of(transfer.transfer->status);
  bool wanted = false;
  {
    const std::lock_guard lock(mutex_);
    transfer.in_flight = false;
    wanted = !closing_ && !over_;
  }
  if (wanted && outcome == UsbOutcome::done) {
    received_({transfer.buffer.data(), static_cast<std::size_t>(transfer.transfer->actual_length)});
    submit(transfer);
  } else if (wanted) {
    end(outcome);
  }
  // Last: the destructor waits for this, and `transfer` is its.
  const std::lock_guard lock(mutex_);
  --in_flight_;
  idle_.notify_all();
}

void UsbReader::end(UsbOutcome outcome) {
  {
    const std::lock_guard lock(mutex_);
    if (over_ || closing_) return;
    over_ = true;
  }
  ended_(outcome);
}

}  // namespace ca2
