#include "emulators/canopen/sdo_server.h"

#include <algorithm>

namespace rigwire::emulators {

namespace canopen = protocols::canopen;
using canopen::SdoAbort;
using canopen::SdoPayload;
using canopen::SdoRequest;
using canopen::SdoRequestKind;

SdoPayload SdoServer::abort(SdoAbort code) {
  transfer_ = Transfer::none;
  return canopen::make_abort(object_, code);
}

std::optional<SdoPayload> SdoServer::answer(SimTime now, const SdoRequest& request,
                                            SdoObjects& objects) {
  switch (request.kind) {
    case SdoRequestKind::upload:
      object_ = request.object;
      return upload(objects);
    case SdoRequestKind::upload_segment:
      return upload_segment(request.toggle);
    case SdoRequestKind::download: {
      object_ = request.object;
      transfer_ = Transfer::none;
      const auto refusal = objects.write(
          now, object_, std::span(request.data).first(request.length), request.size_indicated);
      return refusal ? abort(*refusal) : canopen::make_download_answer(object_);
    }
    case SdoRequestKind::download_segments:
      object_ = request.object;
      if (request.announced > SdoValue::kCapacity) {
        return abort(SdoAbort::too_long);
      }
      transfer_ = Transfer::download;
      announced_ = request.announced;
      value_ = {};
      toggle_ = false;
      return canopen::make_download_answer(object_);
    case SdoRequestKind::download_segment:
      return download_segment(now, request, objects);
    case SdoRequestKind::abort:
      transfer_ = Transfer::none;
      return std::nullopt;
    case SdoRequestKind::other:
      break;
  }
  object_ = request.object;
  return abort(SdoAbort::unknown_command);
}

SdoPayload SdoServer::upload(const SdoObjects& objects) {
  transfer_ = Transfer::none;
  value_ = {};
  if (const auto refusal = objects.read(object_, value_)) {
    return abort(*refusal);
  }
  const auto bytes = value_.content();
  if (!bytes.empty() && bytes.size() <= canopen::kExpeditedBytes) {
    return canopen::make_upload_answer(object_, bytes);
  }
  transfer_ = Transfer::upload;
  done_ = 0;
  toggle_ = false;
  return canopen::make_upload_announcement(object_, static_cast<std::uint32_t>(bytes.size()));
}

SdoPayload SdoServer::upload_segment(bool toggle) {
  if (transfer_ != Transfer::upload) {
    return abort(SdoAbort::unknown_command);
  }
  if (toggle != toggle_) {
    return abort(SdoAbort::toggle_not_alternated);
  }
  const auto content = value_.content();
  const auto bytes = std::min<std::size_t>(canopen::kSdoSegmentBytes, content.size() - done_);
  const auto data = content.subspan(done_, bytes);
  done_ += bytes;
  const bool last = done_ == content.size();
  toggle_ = !toggle_;
  if (last) {
    transfer_ = Transfer::none;
  }
  return canopen::make_upload_segment(toggle, last, data);
}

SdoPayload SdoServer::download_segment(SimTime now, const SdoRequest& request,
                                       SdoObjects& objects) {
  if (transfer_ != Transfer::download) {
    return abort(SdoAbort::unknown_command);
  }
  if (request.toggle != toggle_) {
    return abort(SdoAbort::toggle_not_alternated);
  }
  if (std::size_t{value_.length} + request.length > SdoValue::kCapacity) {
    return abort(SdoAbort::too_long);
  }
  std::copy_n(request.data.begin(), request.length, value_.bytes.begin() + value_.length);
  value_.length = static_cast<std::uint8_t>(value_.length + request.length);
  toggle_ = !toggle_;
  if (request.last) {
    transfer_ = Transfer::none;
    if (announced_ != 0 && announced_ != value_.length) {
      return abort(SdoAbort::length_mismatch);
    }
    if (const auto refusal =
            objects.write(now, object_, std::span(value_.bytes).first(value_.length), true)) {
      return abort(*refusal);
    }
  }
  return canopen::make_download_segment_answer(request.toggle);
}

}  // namespace rigwire::emulators
