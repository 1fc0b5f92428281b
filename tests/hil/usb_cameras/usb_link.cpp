#include "tests/hil/usb_cameras/usb_link.h"

#include <cerrno>
#include <cstdio>

#include <sys/socket.h>
#include <unistd.h>
#include <usbredirparser.h>

namespace bevloc::hil {
namespace {

/// Index of an endpoint in usbredir's table: 0 to 15 for OUT, 16 to 31 for IN endpoints.
constexpr int slot_of(uint8_t endpoint) {
  return ((endpoint & 0x80) >> 3) | (endpoint & 0x0F);
}

/// Converts the result of a socket call for the parser: 0 means try later, -1 means closed.
int parser_result(ssize_t transferred) {
  if (transferred > 0) return static_cast<int>(transferred);
  return transferred < 0 && errno == EAGAIN ? 0 : -1;
}

void describe_device(usbredirparser* parser) {
  usb_redir_interface_info_header interfaces{};
  interfaces.interface_count = 2;
  for (const uint8_t interface : {kControlInterface, kStreamInterface}) {
    interfaces.interface[interface] = interface;
    interfaces.interface_class[interface] = 0x0E;
    interfaces.interface_subclass[interface] = static_cast<uint8_t>(interface + 1);
  }
  usbredirparser_send_interface_info(parser, &interfaces);

  usb_redir_ep_info_header endpoints{};
  for (uint8_t& type : endpoints.type) type = usb_redir_type_invalid;
  for (const uint8_t control : {uint8_t{0x00}, uint8_t{0x80}}) {
    endpoints.type[slot_of(control)] = usb_redir_type_control;
    endpoints.max_packet_size[slot_of(control)] = 64;
  }
  const int stream = slot_of(kStreamEndpoint);
  endpoints.type[stream] = usb_redir_type_bulk;
  endpoints.interface[stream] = kStreamInterface;
  endpoints.max_packet_size[stream] = kMaxPacketBytes;
  usbredirparser_send_ep_info(parser, &endpoints);

  usb_redir_device_connect_header connect{};
  connect.speed = usb_redir_speed_high;
  connect.device_class = 0xEF;
  connect.device_subclass = 2;
  connect.device_protocol = 1;
  connect.vendor_id = kVendorId;
  connect.product_id = kProductId;
  connect.device_version_bcd = 0x0100;
  usbredirparser_send_device_connect(parser, &connect);
}

}  // namespace

/// The parser's callbacks; `link` is its private pointer.
struct UsbLink::Callbacks {
  static UsbLink& self(void* link) { return *static_cast<UsbLink*>(link); }

  static void log(void*, int level, const char* message) {
    if (level <= usbredirparser_warning) std::fprintf(stderr, "usb_cameras: %s\n", message);
  }
  static int read(void* link, uint8_t* data, int count) {
    return parser_result(recv(self(link).fd_, data, static_cast<size_t>(count), MSG_DONTWAIT));
  }
  static int write(void* link, uint8_t* data, int count) {
    return parser_result(
        send(self(link).fd_, data, static_cast<size_t>(count), MSG_DONTWAIT | MSG_NOSIGNAL));
  }
  static void hello(void* link, usb_redir_hello_header*) { describe_device(self(link).parser_); }
  static void reset(void* link) { self(link).function_.reset(); }

  static void set_configuration(void* link, uint64_t id,
                                usb_redir_set_configuration_header* header) {
    self(link).configuration_ = header->configuration;
    get_configuration(link, id);
  }
  static void get_configuration(void* link, uint64_t id) {
    usb_redir_configuration_status_header status{usb_redir_success, self(link).configuration_};
    usbredirparser_send_configuration_status(self(link).parser_, id, &status);
  }
  static void set_alternate(void* link, uint64_t id, usb_redir_set_alt_setting_header* header) {
    self(link).alternate_[header->interface & 1] = header->alt;
    usb_redir_get_alt_setting_header same{header->interface};
    get_alternate(link, id, &same);
  }
  static void get_alternate(void* link, uint64_t id, usb_redir_get_alt_setting_header* header) {
    usb_redir_alt_setting_status_header status{usb_redir_success, header->interface,
                                               self(link).alternate_[header->interface & 1]};
    usbredirparser_send_alt_setting_status(self(link).parser_, id, &status);
  }
  static void cancel(void* link, uint64_t id) { self(link).function_.cancel(id); }

  static void control(void* link, uint64_t id, usb_redir_control_packet_header* header,
                      uint8_t* data, int count) {
    usbredirparser* parser = self(link).parser_;
    const ControlRequest request{header->requesttype, header->request, header->value, header->index,
                                 header->length};
    auto reply =
        self(link).function_.control(request, {data, data ? static_cast<size_t>(count) : 0});
    if (data) usbredirparser_free_packet_data(parser, data);
    usb_redir_control_packet_header answer = *header;
    answer.status = reply ? usb_redir_success : usb_redir_stall;
    const bool to_host = (request.type & 0x80) != 0;
    if (!reply) reply.emplace();
    if (to_host && reply->size() > request.length) reply->resize(request.length);
    if (to_host) answer.length = static_cast<uint16_t>(reply->size());
    usbredirparser_send_control_packet(parser, id, &answer,
                                       reply->empty() ? nullptr : reply->data(),
                                       static_cast<int>(reply->size()));
  }
  static void bulk(void* link, uint64_t id, usb_redir_bulk_packet_header* header, uint8_t* data,
                   int) {
    if (data) usbredirparser_free_packet_data(self(link).parser_, data);
    self(link).function_.bulk_in(id, header->length | (uint32_t{header->length_high} << 16));
  }
};

UsbLink::UsbLink(int fd, UsbFunction& function)
    : fd_(fd), function_(function), parser_(usbredirparser_create()) {
  parser_->priv = this;
  parser_->log_func = Callbacks::log;
  parser_->read_func = Callbacks::read;
  parser_->write_func = Callbacks::write;
  parser_->hello_func = Callbacks::hello;
  parser_->reset_func = Callbacks::reset;
  parser_->set_configuration_func = Callbacks::set_configuration;
  parser_->get_configuration_func = Callbacks::get_configuration;
  parser_->set_alt_setting_func = Callbacks::set_alternate;
  parser_->get_alt_setting_func = Callbacks::get_alternate;
  parser_->cancel_data_packet_func = Callbacks::cancel;
  parser_->control_packet_func = Callbacks::control;
  parser_->bulk_packet_func = Callbacks::bulk;
  uint32_t capabilities[USB_REDIR_CAPS_SIZE] = {};
  for (const auto capability :
       {usb_redir_cap_connect_device_version, usb_redir_cap_ep_info_max_packet_size,
        usb_redir_cap_64bits_ids, usb_redir_cap_32bits_bulk_length}) {
    usbredirparser_caps_set_cap(capabilities, capability);
  }
  usbredirparser_init(parser_, "bevloc lab", capabilities, USB_REDIR_CAPS_SIZE,
                      usbredirparser_fl_usb_host);
}

UsbLink::~UsbLink() {
  usbredirparser_destroy(parser_);
  close(fd_);
}

bool UsbLink::has_data_to_write() const {
  return usbredirparser_has_data_to_write(parser_) > 0;
}

bool UsbLink::read() {
  return usbredirparser_do_read(parser_) != usbredirparser_read_io_error;
}

bool UsbLink::write() {
  return usbredirparser_do_write(parser_) == 0;
}

void UsbLink::complete(uint64_t id, std::span<const uint8_t> data) {
  usb_redir_bulk_packet_header header{};
  header.endpoint = kStreamEndpoint;
  header.status = usb_redir_success;
  header.length = data.size() & 0xFFFF;
  header.length_high = static_cast<uint16_t>(data.size() >> 16);
  // The parser's interface lacks const, but it only copies the data.
  usbredirparser_send_bulk_packet(parser_, id, &header, const_cast<uint8_t*>(data.data()),
                                  static_cast<int>(data.size()));
}

void UsbLink::complete_cancelled(uint64_t id) {
  usb_redir_bulk_packet_header header{};
  header.endpoint = kStreamEndpoint;
  header.status = usb_redir_cancelled;
  usbredirparser_send_bulk_packet(parser_, id, &header, nullptr, 0);
}

}  // namespace bevloc::hil
